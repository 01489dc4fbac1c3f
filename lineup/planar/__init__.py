"""Long paths in one layer of voxels, from one given cell to another (Section 4.1)."""

from .long import Region, Wishes, long_path, path_limit, region, wishes

__all__ = ["Region", "Wishes", "long_path", "path_limit", "region", "wishes"]

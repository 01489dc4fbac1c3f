"""The documentation site has every public name, once, and builds without a warning."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

import lineup as lu

ROOT = Path(__file__).parents[1]


def test_every_public_name_is_on_the_page_of_names():
    page = (ROOT / "docs" / "api.md").read_text()
    shown = re.findall(r"^\.\. auto\w+:: (\w+)$|^\| `(\w+)` \|", page, re.M)
    assert sorted(a or b for a, b in shown) == lu.__all__


@pytest.mark.slow
def test_the_site_builds_offline_without_a_warning(tmp_path):
    pytest.importorskip("myst_nb")
    command = [sys.executable, "-m", "sphinx", "--fail-on-warning", "-c", "docs", "."]
    command.append(str(tmp_path / "html"))
    unreachable = os.environ | {"https_proxy": "http://127.0.0.1:9", "no_proxy": ""}
    subprocess.run(
        [*command, tmp_path / "html"], cwd=ROOT, env=unreachable, check=True, capture_output=True
    )
    page = (tmp_path / "html" / "docs" / "api.html").read_text()
    assert all(f'id="lineup.{name}"' in page for name in ("fold", "certify", "VoxelSolid"))
    assert not re.search(r'(src|href)="https?://[^"]*\.(js|css)"', page)

"""The catalogue: where each model comes from, and that nothing else is taken for it."""

import hashlib
import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
import trimesh

import lineup as lu
from lineup import catalog, shapes

TABLE_2 = [
    "bunny", "decocube", "cannon", "two_holed_torus", "duck",
    "armadillo", "dinosaur", "aircraft", "elephant", "elk",
]  # fmt: skip


@pytest.fixture(autouse=True)
def empty_places(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("LINEUP_MODELS", raising=False)
    monkeypatch.setenv("LINEUP_CACHE", str(tmp_path / "cache"))


@pytest.fixture
def original(monkeypatch: pytest.MonkeyPatch) -> Callable[[bytes], Callable[..., None]]:
    """Make given bytes the pinned original of the bunny; returns a downloader that serves them."""

    def pin(content: bytes) -> Callable[..., None]:
        entries = dict(catalog._entries())
        digest = hashlib.sha256(content).hexdigest()
        entries["bunny"] = replace(entries["bunny"], sha256=digest, path="a/bunny.stl")
        monkeypatch.setattr(catalog, "_entries", lambda: entries)

        def download(url: str, output_file: Any, pooch: Any) -> None:
            Path(output_file).write_bytes(content)

        return download

    return pin


def box_file() -> bytes:
    """A box 1 x 1 x 2 lying along y, as STL; the bunny's original has +y up."""
    data = trimesh.creation.box((1, 2, 1)).export(file_type="stl")
    assert isinstance(data, bytes)
    return data


def test_catalogue_lists_table_2_and_more() -> None:
    table = lu.models()
    assert table["name"].tolist()[:10] == TABLE_2
    assert table["set"].tolist()[:10] == [1] * 5 + [2] * 5
    assert len(table) >= 16
    assert table["name"].is_unique
    assert set(table["name"]) == set(shapes.MODELS)
    assert (table["source"] == "procedural").all()
    assert set(table["kind"]) == {"mesh", "formula"}


def test_originals_are_pinned() -> None:
    for entry in catalog._entries().values():
        pinned = bool(entry.path)
        assert pinned == bool(entry.repository) == bool(entry.licence)
        assert len(entry.commit) == 40 * pinned
        assert len(entry.sha256) == 64 * pinned
        assert entry.up in ("+y", "+z")
        if pinned:
            assert entry.url == (
                f"https://raw.githubusercontent.com/{entry.repository}/{entry.commit}/{entry.path}"
            )


@pytest.mark.parametrize("name", TABLE_2)
def test_procedural_models(name: str) -> None:
    solid = lu.model(name, voxels=150)
    assert abs(solid.size - 150) <= 3
    assert solid.name == name
    assert solid.source["kind"] == "procedural"
    assert json.loads(json.dumps(solid.source)) == solid.source


def test_folder_comes_first(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    trimesh.creation.box((1, 1, 2)).export(tmp_path / "bunny.ply")
    monkeypatch.setenv("LINEUP_MODELS", str(tmp_path))
    table = lu.models().set_index("name")["source"]
    assert (table["bunny"], table["duck"]) == ("folder", "procedural")
    solid = lu.model("bunny", voxels=250)
    assert solid.occupancy.shape == (5, 5, 10)
    assert (solid.source["kind"], solid.source["file"]) == ("folder", "bunny.ply")
    assert str(tmp_path) not in json.dumps(solid.source)
    assert lu.model("duck", voxels=100).source["kind"] == "procedural"


def test_folder_that_is_none_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("LINEUP_MODELS", "no/such/folder")
    with pytest.raises(ValueError, match="LINEUP_MODELS must name a folder"):
        lu.model("bunny", voxels=100)


def test_fetched_original_is_turned_up(original: Callable[..., Any]) -> None:
    download = original(box_file())
    assert lu.models()["source"][0] == "procedural"
    files = catalog.fetch(["bunny"], downloader=download)
    assert files["bunny"].name == "bunny.stl"
    assert lu.models()["source"][0] == "original"
    solid = lu.model("bunny", voxels=250)
    assert solid.source["kind"] == "original"
    assert solid.source["sha256"] == hashlib.sha256(box_file()).hexdigest()
    assert solid.occupancy.shape == (5, 5, 10)
    assert lu.model("bunny", voxels=250, up="+x").occupancy.shape[2] == 5
    assert lu.model("bunny", voxels=250, up=(1, 0, 0)).source["up"] == [1.0, 0.0, 0.0]


def test_wrong_download_is_refused_and_not_kept(original: Callable[..., Any]) -> None:
    original(box_file())

    def download(url: str, output_file: Any, pooch: Any) -> None:
        Path(output_file).write_bytes(b"another mesh")

    with pytest.raises(ValueError, match="not the bunny of the catalogue") as error:
        catalog.fetch(["bunny"], downloader=download)
    assert "\n" not in str(error.value)
    assert lu.models()["source"][0] == "procedural"


@pytest.mark.parametrize("content", [b"", box_file()[:-9], box_file() + b"0"])
def test_cached_file_that_was_changed_is_refused(
    original: Callable[..., Any], content: bytes
) -> None:
    file = catalog.fetch(["bunny"], downloader=original(box_file()))["bunny"]
    file.write_bytes(content)
    with pytest.raises(ValueError, match="fetch it again, or delete it"):
        lu.model("bunny", voxels=100)


def test_failed_download_is_one_line(original: Callable[..., Any]) -> None:
    original(box_file())

    def download(url: str, output_file: Any, pooch: Any) -> None:
        raise OSError("name resolution failed\nsee above")

    with pytest.raises(ConnectionError, match=r"^bunny could not be fetched .* failed$"):
        catalog.fetch(["bunny"], downloader=download)


def test_formulas_are_not_fetched() -> None:
    with pytest.raises(ValueError, match="'mug' is a formula"):
        catalog.fetch(["mug"])


def test_unknown_models_get_a_hint() -> None:
    with pytest.raises(ValueError, match="did you mean bunny"):
        lu.model("buny")
    with pytest.raises(ValueError, match="there are bunny, decocube"):
        lu.model("zzz")
    with pytest.raises(ValueError, match="voxels must be an integer"):
        lu.model("bunny", voxels=0)
    with pytest.raises(ValueError, match="up must be"):
        lu.model("mug", voxels=100, up="sideways")

"""The committed ELF images are complete, tell nothing of the machine that built them, and can be rebuilt."""

from __future__ import annotations

import importlib.util
import io
import random
import shutil
import struct
import subprocess
import sys
from pathlib import Path

import pytest
from elftools.elf.elffile import ELFFile
from robot.codels import CODELS, GPS_CAPACITY, IMU_CAPACITY, ROOT, TTRK, Robot, State, fix, gps_frame, imu_packet
from wcet.fixtures.bad_images import bad_images

FIXTURES = ROOT / "tests" / "wcet" / "fixtures"
IMAGES = sorted([TTRK / "ttrk.elf", *FIXTURES.glob("*.elf")])
COMPILERS = {
    "gcc": shutil.which("arm-none-eabi-gcc") is not None,
    "clang": importlib.util.find_spec("ziglang") is not None,
}


def test_there_are_images() -> None:
    assert len(IMAGES) == 10


@pytest.mark.parametrize("image", IMAGES, ids=lambda image: image.name)
def test_an_image_names_no_checkout_and_no_build(image: Path) -> None:
    content = image.read_bytes()
    assert str(ROOT).encode() not in content
    with image.open("rb") as stream:
        elf = ELFFile(stream)
        assert elf.get_section_by_name(".note.gnu.build-id") is None
        assert elf["e_machine"] == "EM_ARM" and elf.little_endian
        for unit in elf.get_dwarf_info().iter_CUs():
            name = unit.get_top_DIE().attributes["DW_AT_name"].value.decode()
            folder = unit.get_top_DIE().attributes["DW_AT_comp_dir"].value.decode()
            own = not name.startswith(("/", "../"))
            assert not own or folder in (".", "") or "libgcc" in folder, (name, folder)


@pytest.mark.parametrize("image", IMAGES, ids=lambda image: image.name)
def test_lines_lead_to_sources_that_are_there(image: Path) -> None:
    files = set()
    with image.open("rb") as stream:
        for unit in ELFFile(stream).get_dwarf_info().iter_CUs():
            die = unit.get_top_DIE().attributes
            if die["DW_AT_comp_dir"].value == b".":
                files.add(die["DW_AT_name"].value.decode())
    assert files
    assert all((image.parent / file).is_file() for file in files)


def symbols(image: Path) -> dict[str, tuple[int, int]]:
    with image.open("rb") as stream:
        table = ELFFile(stream).get_section_by_name(".symtab")
        assert table is not None
        return {s.name: (s["st_value"], s["st_size"]) for s in table.iter_symbols() if s.name}  # type: ignore[attr-defined]


def compiler_of(image: Path) -> bytes:
    with image.open("rb") as stream:
        section = ELFFile(stream).get_section_by_name(".comment")
        return section.data() if section else b""


def assert_fits_the_memory_map(image: Path) -> None:
    """Code and constants in the 64 KiB instruction memory, above the vectors; no data segment at all."""
    with image.open("rb") as stream:
        for segment in ELFFile(stream).iter_segments("PT_LOAD"):
            if segment["p_memsz"]:
                assert segment["p_vaddr"] >= 0x40 and segment["p_vaddr"] + segment["p_memsz"] <= 0x1_0000
    names = symbols(image)
    assert all(names[codel][1] > 0 for codel in CODELS)


def test_the_robot_fits_its_memory_map() -> None:
    assert_fits_the_memory_map(TTRK / "ttrk.elf")
    assert (TTRK / "ttrk.elf").stat().st_size < 100_000


def observe(image: Path, seed: int) -> list[object]:
    """Everything that the codels of an image answer to a random but reproducible mission."""
    draw, robot, seen = random.Random(seed), Robot(image), list[object]()
    robot.open()
    for step in range(1, 12):
        frame = bytearray(gps_frame(fix(step * 10, 43.5 + draw.gauss(0, 1e-5), 1.4 + draw.gauss(0, 1e-5), 150.0)))
        if draw.random() < 0.3:
            frame[draw.randrange(len(frame))] ^= 1 << draw.randrange(8)
        robot.gps_receives(bytes(draw.choices(b"\xff\x02\x03x", k=draw.randrange(5))) + bytes(frame))
        position = robot.read_gps()
        yaws = []
        for _ in range(draw.randrange(4)):
            robot.imu_receives(imu_packet({channel: draw.randrange(-16384, 16384) for channel in range(6)}))
            yaws.append(robot.read_imu()[2])
        seen += [position, robot.gps_counters(), robot.imu_counters(), yaws]
        robot.fuse(position, yaws)
        estimate = robot.estimate()
        robot.aim(estimate, (draw.uniform(-20, 20), draw.uniform(-20, 20), draw.uniform(-3, 3)))
        seen += [estimate, robot.covariance(), robot.guard("aligned"), robot.guard("strayed")]
        for codel in ("rotate", "reach", "halt"):
            left, right = robot.control(codel)
            seen += [left, right, robot.send(left, right)]
            if draw.random() < 0.7:
                robot.sent()
    return seen


@pytest.mark.slow
@pytest.mark.parametrize("compiler", COMPILERS)
def test_rebuilt_images_behave_as_the_committed_one(compiler: str, tmp_path: Path) -> None:
    """Both compilers build every codel; results agree to the last bit, since both round as IEEE 754 says."""
    if not COMPILERS[compiler]:
        pytest.skip(f"{compiler} is not installed")
    rebuilt = tmp_path / "ttrk.elf"
    script = [sys.executable, str(TTRK / "build.py"), "--compiler", compiler, "--output", str(rebuilt)]
    subprocess.run(script, check=True)
    assert_fits_the_memory_map(rebuilt)
    assert str(TTRK).encode() not in rebuilt.read_bytes()
    for seed in range(4):
        assert observe(rebuilt, seed) == observe(TTRK / "ttrk.elf", seed)


@pytest.mark.slow
def test_the_makefiles_rebuild_the_images(tmp_path: Path) -> None:
    """From a copy in another folder the same functions come out; with the same compiler release, the same bytes."""
    if not COMPILERS["gcc"] or shutil.which("make") is None:
        pytest.skip("arm-none-eabi-gcc or make is not installed")
    for folder in (TTRK, FIXTURES):
        copy = tmp_path / folder.name
        shutil.copytree(folder, copy)
        subprocess.run(["make", "-B", "-s", "-C", str(copy)], check=True)
        for image in folder.glob("*.elf"):
            functions = {name for name, (_, size) in symbols(image).items() if size and not name.startswith("_")}
            assert functions <= set(symbols(copy / image.name)), image.name
            assert str(tmp_path).encode() not in (copy / image.name).read_bytes()
            if compiler_of(copy / image.name) == compiler_of(image):
                assert (copy / image.name).read_bytes() == image.read_bytes(), f"{image.name} is older than its sources"


def test_bad_images_are_bad_in_the_way_they_say() -> None:
    """The set of broken files that other tests feed to the tool: pyelftools reads the well-formed ones as named."""
    broken = bad_images((FIXTURES / "arm7tdmi-arm-O2.elf").read_bytes())
    assert len(broken) == len(set(broken.values()))
    assert struct.unpack_from("<H", broken["relocatable"], 16) == (1,)
    expected = {"x86": "EM_386", "x86-64": "EM_X86_64", "aarch64": "EM_AARCH64", "big-endian": "EM_ARM"}
    for name, machine in expected.items():
        elf = ELFFile(io.BytesIO(broken[name]))
        assert elf["e_machine"] == machine
        assert elf.little_endian == (name != "big-endian")
    bare = ELFFile(io.BytesIO(broken["stripped"]))
    assert bare.get_section_by_name(".text") is not None
    assert bare.get_section_by_name(".symtab") is None
    assert ELFFile(io.BytesIO(broken["without-sections"])).num_sections() == 0


@pytest.mark.parametrize("image", [TTRK / "ttrk.elf"], ids=["ttrk"])
def test_worst_inputs_stay_affordable(image: Path) -> None:
    """Executed instructions for inputs near the worst, against what the periods leave on this core."""
    robot = Robot(image)
    robot.open()
    robot.gps_receives(bytes(GPS_CAPACITY - 56) + gps_frame(fix(1, 1, 1, 1) + bytes(30)))
    gps = robot.emulator.call("IG500_read", [robot.gps, robot.position]).instructions
    robot.imu_receives(bytes(IMU_CAPACITY - 39) + imu_packet(dict.fromkeys(range(15), -1))[: 39])
    imu = robot.emulator.call("CHR6dm_read", [robot.imu, robot.attitude]).instructions
    yaws = [(-1.0) ** i * 3.1 for i in range(16)]
    fuse = max(robot.fuse(robot.read_gps(), yaws).instructions for _ in range(3))
    robot.aim(State(1.0, -1.0, 2.9, 0.3, 0.2), (-3.7, 2.9, 0.0))
    control = [
        robot.emulator.call(f"Command_{codel}", [robot.state, robot.target, robot.command]).instructions
        for codel in ("rotate", "reach")
    ]
    assert gps < 10_000 and imu < 3_000 and fuse < 120_000 and max(control) < 30_000


@pytest.mark.parametrize("place", ["ig500.c:60", "chr6dm.c:46"])
def test_the_places_of_the_flow_facts_are_the_scans(place: str) -> None:
    """The README and the deployment name these lines: they must stay on the two loops that data ends."""
    file, _, line = place.partition(":")
    assert "while (scan[0] !=" in (TTRK / file).read_text().splitlines()[int(line) - 1]
    assert place in (TTRK / "README.md").read_text()

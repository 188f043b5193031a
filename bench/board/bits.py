"""Runs the identification as compiled for the board (Cortex-M4F) in an emulator.

Compares its fingerprints with those of the host (tests/golden/fingerprint-v1.txt) and counts instructions a sample of each method.

    pip install unicorn
    python bench/board/bits.py

Builds firmware/src/bits.rs for thumbv7em-none-eabihf itself. Exits 1 if a bit differs.
"""

import os
import pathlib
import struct
import subprocess
import sys

from unicorn import UC_ARCH_ARM, UC_HOOK_CODE, UC_HOOK_MEM_WRITE, UC_MODE_MCLASS, UC_MODE_THUMB, Uc
from unicorn.arm_const import UC_ARM_REG_C1_C0_2, UC_ARM_REG_FPEXC, UC_ARM_REG_SP, UC_CPU_ARM_CORTEX_M4

ROOT = pathlib.Path(__file__).resolve().parents[2]
PORT, STACK, PAGE = 0x4000_0000, 0x2000_0000, 0x1000
END, END_OF_PIECES = 0xFFFF_FFFF, 0xFFFF_FFFE
HASHES = ["search", "profile", "filter", "offset filter"]
PIECES = {
    1: "variance search, one sample",
    2: "fast search, one sample",
    3: "filter of two states, projection, one sample",
    4: "filter of two states, constrained twice linearised, one sample",
    5: "filter of three states about a reference, one sample",
    6: "variance search, best and runner-up",
    7: "fast search, mu and alpha",
    8: "variance search, error of the best column for telemetry",
}


def build():
    """The program for the board, as the image is compiled."""
    target = "thumbv7em-none-eabihf"
    command = ["cargo", "build", "--profile", "board", "--target", target, "-p", "firmware"]
    command += ["--bin", "bits", "--features", "bits"]
    subprocess.run(command, cwd=ROOT, check=True)
    folder = pathlib.Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target"))
    return (folder / target / "board/bits").read_bytes()


def load(machine, elf):
    """Maps and writes the segments of a 32-bit little-endian ELF file; returns its entry."""
    entry, header = struct.unpack_from("<II", elf, 24)
    size, count = struct.unpack_from("<HH", elf, 42)
    pages = set()
    for i in range(count):
        kind, offset, at, _, length, memory = struct.unpack_from("<IIIIII", elf, header + i * size)
        if kind != 1 or memory == 0:
            continue
        for page in range(at // PAGE, (at + memory - 1) // PAGE + 1):
            if page not in pages:
                machine.mem_map(page * PAGE, PAGE)
                pages.add(page)
        machine.mem_write(at, elf[offset : offset + length])
    return entry


def run(elf, counting):
    """What the program tells: numbers with the instructions before each of them (0 unless counting; then only the pieces are run)."""
    machine = Uc(UC_ARCH_ARM, UC_MODE_THUMB | UC_MODE_MCLASS)
    machine.ctl_set_cpu_model(UC_CPU_ARM_CORTEX_M4)
    entry = load(machine, elf)
    machine.mem_map(STACK, 0x30000)
    machine.mem_map(PORT, PAGE)
    machine.reg_write(UC_ARM_REG_SP, STACK + 0x30000 - 16)
    machine.reg_write(UC_ARM_REG_C1_C0_2, 0xF << 20)
    machine.reg_write(UC_ARM_REG_FPEXC, 1 << 30)
    told, instructions = [], [0]

    def count(*_):
        instructions[0] += 1

    def tell(uc, _access, _address, _size, value, _data):
        value &= 0xFFFF_FFFF
        if value == END or (counting and value == END_OF_PIECES):
            uc.emu_stop()
        else:
            told.append((value, instructions[0]))
            instructions[0] = 0

    if counting:
        machine.hook_add(UC_HOOK_CODE, count)
    machine.hook_add(UC_HOOK_MEM_WRITE, tell, begin=PORT, end=PORT + 3)
    machine.emu_start(entry | 1, 0)
    return told


def main():
    """Runs the program and compares."""
    elf = build()
    told = [number for number, _ in run(elf, False)]
    told = told[told.index(END_OF_PIECES) + 1 :]
    golden = dict(line.rsplit(" ", 1) for line in (ROOT / "tests/golden/fingerprint-v1.txt").read_text().splitlines())
    bad = 0
    for i, name in enumerate(HASHES):
        found = f"{told[2 * i] | told[2 * i + 1] << 32:016x}" if len(told) > 2 * i + 1 else "none"
        same = found == golden.get(name)
        bad += not same
        print(f"{name:14} board {found}  host {golden.get(name)}  {'same' if same else 'DIFFERENT'}")
    counts = {}
    for piece, instructions in run(elf, True):
        counts.setdefault(piece, []).append(instructions)
    for piece, name in PIECES.items():
        if piece in counts:
            print(f"{sum(counts[piece]) / len(counts[piece]):9.0f} instructions  {name}")
    sys.exit(1 if bad else 0)


if __name__ == "__main__":
    main()

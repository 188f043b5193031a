#!/bin/sh
# Size of the board's image against its budget; exits 1 above it.
#
# Usage: firmware/size-budget.sh [ELF]
# Build first: cargo build --profile board --target thumbv7em-none-eabihf -p firmware --features board
# Needs `size` of binutils (any target), or `llvm-size`.
set -eu

root=$(cd "$(dirname "$0")/.." && pwd)
elf=${1:-${CARGO_TARGET_DIR:-$root/target}/thumbv7em-none-eabihf/board/palpate-board}
# Code and constants of 128 KiB leave five sixths of bank 1; of 192 KiB of RAM the stack has 64 KiB to itself.
text_budget=131072
ram_budget=98304

[ -f "$elf" ] || { echo "size-budget: $elf does not exist: build the board first" >&2; exit 2; }
tool=$(command -v size || command -v llvm-size || command -v rust-size) || {
    echo "size-budget: neither size, llvm-size nor rust-size is installed" >&2
    exit 2
}

"$tool" -A "$elf" | awk -v text_budget="$text_budget" -v ram_budget="$ram_budget" '
    $1 == ".vector_table" || $1 == ".text" || $1 == ".rodata" { text += $2; printf "%-14s %7d bytes\n", $1, $2 }
    $1 == ".data" { text += $2 }
    $1 == ".data" || $1 == ".bss" || $1 == ".uninit" { ram += $2; printf "%-14s %7d bytes\n", $1, $2 }
    END {
        if (text == 0) { print "size-budget: no sections found"; exit 2 }
        printf "flash          %7d bytes of %d\n", text, text_budget
        printf "RAM (static)   %7d bytes of %d\n", ram, ram_budget
        if (text > text_budget || ram > ram_budget) { print "size-budget: over budget"; exit 1 }
    }'

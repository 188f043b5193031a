# `just check` is what CI runs, beside the demo. Every recipe is a plain command that works without `just` as well.

board_target := "thumbv7em-none-eabihf"

# What CI runs; there with one build for everything.
check: format lint docs board slurm monitor emulator test

# Formatting, as rustfmt.toml has it.
format:
    cargo fmt --all -- --check

# Clippy on host and board code, warnings denied.
lint:
    cargo clippy --workspace --all-targets -- -D warnings
    cargo clippy -p protocol --target {{board_target}} -- -D warnings
    cargo clippy --profile board --target {{board_target}} -p firmware --features board -- -D warnings

# API documentation, warnings (broken links, missing docs) denied.
docs:
    RUSTDOCFLAGS="-D warnings" cargo doc --workspace --no-deps

# The board's image, and its size against the budget.
board:
    cargo build --profile board --target {{board_target}} -p firmware --features board
    firmware/size-budget.sh

# The real image on an emulated board; needs cmake and libclang, which it installs with apt-get where it can.
emulator:
    cargo build --release
    .ci/emulator "${CARGO_TARGET_DIR:-target}/release/palpate"

# The README's test command.
test:
    cargo test --workspace

# A sweep as a job array on a one-node Slurm cluster, or its batch script alone where there is none.
slurm:
    cargo build --release
    .ci/slurm "${CARGO_TARGET_DIR:-target}/release/palpate"

# The monitor in a real terminal (tmux, installed with apt-get where it can be).
monitor:
    cargo build --release
    .ci/monitor "${CARGO_TARGET_DIR:-target}/release/palpate"

# Fuzzes everything that comes from outside, ten minutes each: docs/robustness.md.
fuzz:
    tests/fuzz/run

# The demo, as the README has it.
demo:
    cargo run --release -- demo

# Re-bless golden files after a change that is meant.
bless:
    PALPATE_BLESS=1 cargo test -p tests

# The figures in docs/, made again.
figures:
    cargo run --release -- demo --out out/demo
    cp out/demo/overview.svg docs/figures/demo.svg

# The tables of docs/verification.md, made again.
verification:
    cargo run --release -p tests --example verification

# Instructions of the board's code into docs/performance.md; exits 1 above a budget. After `just board`.
measure:
    cargo build --profile board --target {{board_target}} -p firmware --bin bits --features bits
    cd tests/emulator && cargo run --bin measure -- --write

# The screen of docs/monitor.md, made again.
screen:
    cargo build --release
    .ci/monitor "${CARGO_TARGET_DIR:-target}/release/palpate" --write

# Times against CalculiX (Debian's calculix-ccx) into docs/performance.md; some five minutes.
versus-calculix:
    bench/versus-calculix/run

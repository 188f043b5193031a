//! The `palpate` command.

fn main() -> std::process::ExitCode {
    palpate::cli::main()
}

//! The `trimray` command. Everything it does is in [`trimray::cli`].

fn main() -> std::process::ExitCode {
    trimray::cli::main()
}

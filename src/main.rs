fn main() -> std::process::ExitCode {
    foldline::cli::main()
}

//! `tyndall`: serves, renders, submits, plans, checks, compares and measures scenes with participating media.
//!
//! Exit codes: 0 done; 1 a file, scene or device is at fault, with one line on standard error that
//! names it; 2 the command line is.

mod commands;
mod output;
mod scene_argument;

use std::io::IsTerminal as _;
use std::process::ExitCode;

use clap::{Parser, Subcommand};

/// Fog, smoke and clouds, rendered on a GPU.
#[derive(Debug, Parser)]
#[command(name = "tyndall", version, about, max_term_width = 100)]
struct Arguments {
    /// More on standard error: info (default), debug, trace, or a filter like `wgpu=warn`.
    #[arg(
        long,
        global = true,
        env = "TYNDALL_LOG",
        default_value = "info,wgpu=warn,naga=warn,wgpu_hal::vulkan::instance=off"
    )]
    log: String,
    /// One JSON object a line instead of text.
    #[arg(long, global = true)]
    log_json: bool,
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Serve the page and stream pictures to it.
    Serve(commands::serve::Serve),
    /// Render a scene to an EXR or PNG file.
    Render(commands::render::Render),
    /// Render a scene on a server and fetch the pictures.
    Submit(commands::submit::Submit),
    /// Print every error measure of a picture against a reference.
    Compare(commands::compare::Compare),
    /// Print which passes a scene needs and why, and which are skipped.
    Plan(commands::plan::Plan),
    /// Validate a scene without rendering it.
    Check(commands::check::Check),
    /// List the adapters, best first.
    Adapters(commands::adapters::Adapters),
    /// Measure run time against error, over scenes, techniques and settings.
    Bench(commands::bench::Bench),
}

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    if let Err(error) = start_log(&arguments) {
        eprintln!("tyndall: {error}");
        return ExitCode::from(2);
    }
    let result = match arguments.command {
        Command::Serve(command) => command.run(),
        Command::Render(command) => command.run(),
        Command::Submit(command) => command.run(),
        Command::Compare(command) => command.run(),
        Command::Plan(command) => command.run(),
        Command::Check(command) => command.run(),
        Command::Adapters(command) => command.run(),
        Command::Bench(command) => command.run(),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("tyndall: {}", one_line(&error));
            ExitCode::FAILURE
        }
    }
}

/// Whatever is asked for: the names of sessions, which are secret, stand in what these libraries print of
/// their messages, and the list of the page's files is of no use to anybody.
const KEPT_QUIET: [&str; 5] = [
    "hyper=info",
    "hyper_util=info",
    "memory_serve=warn",
    "tokio_tungstenite=info",
    "tungstenite=info",
];

/// An error and its causes in one line, in which nothing is said twice: many errors name their cause
/// themselves.
fn one_line(error: &anyhow::Error) -> String {
    error.chain().fold(String::new(), |line, cause| {
        let cause = cause.to_string();
        if line.contains(&cause) {
            line
        } else if line.is_empty() || cause.contains(&line) {
            cause
        } else {
            format!("{line}: {cause}")
        }
    })
}

fn start_log(arguments: &Arguments) -> Result<(), String> {
    let filter = tracing_subscriber::EnvFilter::try_new(&arguments.log)
        .map_err(|error| format!("--log {:?}: {error}", arguments.log))?;
    let filter = KEPT_QUIET.iter().try_fold(filter, |filter, directive| {
        let parsed = directive
            .parse()
            .map_err(|error| format!("{directive}: {error}"));
        parsed.map(|directive| filter.add_directive(directive))
    })?;
    let wants_colour = std::env::var_os("NO_COLOR").is_none_or(|value| value.is_empty());
    let builder = tracing_subscriber::fmt()
        .with_env_filter(filter)
        .with_ansi(wants_colour && std::io::stderr().is_terminal())
        .with_writer(std::io::stderr);
    if arguments.log_json {
        builder.json().init();
    } else {
        builder.init();
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_error_says_nothing_twice() {
        let inner = anyhow::anyhow!("no such file");
        let named = inner
            .context("scene: a.json: no such file")
            .context("a.json");
        assert_eq!(one_line(&named), "scene: a.json: no such file");
        let other = anyhow::anyhow!("too dark").context("FLIP");
        assert_eq!(one_line(&other), "FLIP: too dark");
    }
}

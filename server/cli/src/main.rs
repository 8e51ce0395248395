//! `tyndall`: serves, renders, plans, checks, compares and measures scenes with participating media.
//!
//! Exit codes: 0 done; 1 a file, scene or device is at fault, with one line on standard error that
//! names it; 2 the command line is.

mod commands;
mod output;
mod scene_argument;

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
    /// Print every error measure of a picture against a reference.
    Compare(commands::compare::Compare),
    /// Print which passes a scene needs and why, and which are skipped.
    Plan(commands::plan::Plan),
    /// Validate a scene without rendering it.
    Check(commands::check::Check),
    /// List the adapters, best first.
    Adapters(commands::adapters::Adapters),
    /// Measure frames: time of every pass, noise, memory.
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
        Command::Compare(command) => command.run(),
        Command::Plan(command) => command.run(),
        Command::Check(command) => command.run(),
        Command::Adapters(command) => command.run(),
        Command::Bench(command) => command.run(),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("tyndall: {error:#}");
            ExitCode::FAILURE
        }
    }
}

fn start_log(arguments: &Arguments) -> Result<(), String> {
    let filter = tracing_subscriber::EnvFilter::try_new(&arguments.log)
        .map_err(|error| format!("--log {:?}: {error}", arguments.log))?;
    let builder = tracing_subscriber::fmt()
        .with_env_filter(filter)
        .with_writer(std::io::stderr);
    if arguments.log_json {
        builder.json().init();
    } else {
        builder.init();
    }
    Ok(())
}

//! What the binary does: one file for each command.

pub mod demo;
pub mod health;
pub mod openapi;
pub mod serve;

use std::process::ExitCode;

use clap::{Parser, Subcommand};

/// Predicts how a face will look after the bones under it are moved. Not a medical device.
#[derive(Parser)]
#[command(name = "facies", version)]
pub struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Serve the API, with workers in the same process
    Serve(serve::ServeArgs),
    /// Predict a face that the program makes itself, and say how good the numbers are
    Demo(demo::DemoArgs),
    /// Ask a running service whether it is alive; for health checks of containers
    Health(health::HealthArgs),
    /// Print the OpenAPI description of the service
    Openapi,
}

/// Does what the arguments ask for.
pub fn run(arguments: Arguments) -> ExitCode {
    match arguments.command {
        Command::Serve(arguments) => match serve::serve(&arguments) {
            Ok(()) => ExitCode::SUCCESS,
            Err(error) => failed(&error, error.exit_code()),
        },
        Command::Demo(arguments) => match demo::demo(&arguments) {
            Ok(()) => ExitCode::SUCCESS,
            Err(error) => failed(&error, error.exit_code()),
        },
        Command::Health(arguments) => match health::health(&arguments) {
            Ok(()) => ExitCode::SUCCESS,
            Err(error) => failed(&error, error.exit_code()),
        },
        Command::Openapi => match openapi::openapi() {
            Ok(()) => ExitCode::SUCCESS,
            Err(error) => failed(&error, serve::EXIT_INFRASTRUCTURE),
        },
    }
}

/// One line on standard error.
fn failed(error: &dyn std::error::Error, code: u8) -> ExitCode {
    eprintln!("facies: {error}");
    ExitCode::from(code)
}

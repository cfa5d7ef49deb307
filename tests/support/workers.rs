//! Workers in processes of their own.

use std::io::{BufRead, BufReader};
use std::process::{Child, ChildStdout, Command, Stdio};

use crate::deployments::Deployment;
use crate::helpers::LEASES;

/// A worker in a process of its own. It is killed when the test ends.
pub struct Worker(Child);

impl Worker {
    pub fn start(on: &Deployment) -> Worker {
        Worker::start_with(on, &[]).0
    }

    /// The worker, and what it says.
    pub fn start_with(on: &Deployment, arguments: &[&str]) -> (Worker, BufReader<ChildStdout>) {
        let mut command = Worker::command(on);
        // Of a setting that is given twice the last one counts.
        command.args(arguments);
        Worker::start_command(command)
    }

    pub fn command(on: &Deployment) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_facies"));
        command.args(["worker", "--workers", "1"]).args(LEASES);
        on.bring(&mut command);
        command
    }

    pub fn process(&self) -> u32 {
        self.0.id()
    }

    pub fn start_command(mut command: Command) -> (Worker, BufReader<ChildStdout>) {
        let mut child = command.stdout(Stdio::piped()).stderr(Stdio::null()).spawn().unwrap();
        let mut line = String::new();
        let mut said = BufReader::new(child.stdout.take().unwrap());
        said.read_line(&mut line).unwrap();
        assert_eq!(line, "working with 1 workers\n");
        (Worker(child), said)
    }
}

impl Drop for Worker {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

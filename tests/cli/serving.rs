//! Drives that are served beside a test.

use std::io::{BufRead, BufReader};
use std::net::UdpSocket;
use std::process::{Child, Stdio};

use super::program::command;

/// Drives that are served over UDP until the test is over, whatever its outcome.
pub struct Serving {
    process: Child,
    /// Where they are.
    pub address: String,
    /// The first line that the program has printed.
    pub line: String,
}

impl Serving {
    /// Serves drives on this computer.
    pub fn over_udp(options: &[&str]) -> Self {
        // A port that was free a moment ago.
        let port = UdpSocket::bind("127.0.0.1:0")
            .and_then(|socket| socket.local_addr())
            .expect("a free port")
            .port();
        let address = format!("127.0.0.1:{port}");
        let process = command(["run", "--udp", &address].iter().chain(options))
            .stdout(Stdio::piped())
            .spawn()
            .expect("the program starts");
        let mut serving = Self {
            process,
            address,
            line: String::new(),
        };
        let out = serving.process.stdout.take().expect("a pipe");
        BufReader::new(out).read_line(&mut serving.line).expect("a line");
        serving
    }
}

impl Drop for Serving {
    fn drop(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

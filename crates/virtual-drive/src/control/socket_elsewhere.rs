//! The control socket where there are no Unix sockets: it cannot be made, and nobody can be asked.

use std::convert::Infallible;
use std::path::Path;
use std::sync::mpsc::Receiver;

use anyhow::bail;

use super::{Answer, Order, Request};

/// The server's end; cannot exist on this operating system.
#[derive(Debug)]
pub struct ControlSocket(Infallible);

impl ControlSocket {
    /// Always an error here.
    ///
    /// # Errors
    /// There are no Unix sockets.
    pub fn bind(_path: &Path) -> anyhow::Result<Self> {
        bail!("a control socket needs an operating system with Unix sockets")
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        match self.0 {}
    }

    /// The orders.
    pub const fn requests(&self) -> &Receiver<Request> {
        match self.0 {}
    }
}

/// Always an error here.
///
/// # Errors
/// There are no Unix sockets.
pub fn ask(_path: &Path, _order: Order) -> anyhow::Result<Answer> {
    bail!("a control socket needs an operating system with Unix sockets")
}

//! The memory behind the parameter store, as boards offer it, and as the store's library wants it.

use core::future::Future;
use core::pin::pin;
use core::task::{Context, Poll, Waker};

use embedded_storage::nor_flash::{ErrorType, NorFlash, NorFlashError, NorFlashErrorKind, ReadNorFlash};
use embedded_storage_async::nor_flash as asynchronous;

/// The memory of a board that has none: saving answers 0x08000020, and every start is with the parameters of delivery.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoMemory;

impl ErrorType for NoMemory {
    type Error = NorFlashErrorKind;
}

impl ReadNorFlash for NoMemory {
    const READ_SIZE: usize = 1;

    fn read(&mut self, _: u32, _: &mut [u8]) -> Result<(), NorFlashErrorKind> {
        Err(NorFlashErrorKind::OutOfBounds)
    }

    fn capacity(&self) -> usize {
        0
    }
}

impl NorFlash for NoMemory {
    const WRITE_SIZE: usize = 1;
    const ERASE_SIZE: usize = 1024;

    fn erase(&mut self, _: u32, _: u32) -> Result<(), NorFlashErrorKind> {
        Err(NorFlashErrorKind::OutOfBounds)
    }

    fn write(&mut self, _: u32, _: &[u8]) -> Result<(), NorFlashErrorKind> {
        Err(NorFlashErrorKind::OutOfBounds)
    }
}

/// A flash whose operations are complete when they return, behind the traits of those that take their time.
pub(crate) struct Immediate<'a, M> {
    memory: &'a mut M,
    writable: bool,
}

impl<'a, M> Immediate<'a, M> {
    /// A flash to read only: writing and erasing fail.
    pub(crate) const fn read_only(memory: &'a mut M) -> Self {
        Self { memory, writable: false }
    }

    /// A flash to read and write.
    pub(crate) const fn writable(memory: &'a mut M) -> Self {
        Self { memory, writable: true }
    }

    fn check_writable(&self) -> Result<(), NorFlashErrorKind> {
        if self.writable { Ok(()) } else { Err(NorFlashErrorKind::Other) }
    }
}

impl<M> ErrorType for Immediate<'_, M> {
    type Error = NorFlashErrorKind;
}

impl<M: ReadNorFlash> asynchronous::ReadNorFlash for Immediate<'_, M> {
    const READ_SIZE: usize = M::READ_SIZE;

    async fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), NorFlashErrorKind> {
        self.memory.read(offset, bytes).map_err(|error| error.kind())
    }

    fn capacity(&self) -> usize {
        self.memory.capacity()
    }
}

impl<M: NorFlash> asynchronous::NorFlash for Immediate<'_, M> {
    const WRITE_SIZE: usize = M::WRITE_SIZE;
    const ERASE_SIZE: usize = M::ERASE_SIZE;

    async fn erase(&mut self, from: u32, to: u32) -> Result<(), NorFlashErrorKind> {
        self.check_writable()?;
        self.memory.erase(from, to).map_err(|error| error.kind())
    }

    async fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), NorFlashErrorKind> {
        self.check_writable()?;
        self.memory.write(offset, bytes).map_err(|error| error.kind())
    }
}

/// What a future over an [`Immediate`] flash comes to. It has nothing to wait for, so that its first step is its last; `None` for
/// another that does wait.
pub(crate) fn at_once<T>(future: impl Future<Output = T>) -> Option<T> {
    match pin!(future).poll(&mut Context::from_waker(Waker::noop())) {
        Poll::Ready(value) => Some(value),
        Poll::Pending => None,
    }
}

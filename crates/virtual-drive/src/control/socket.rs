//! Both ends of the control socket.

use std::fs;
use std::io::{self, Read, Write};
use std::os::unix::fs::{FileTypeExt, MetadataExt};
use std::os::unix::net::{UnixListener, UnixStream};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::thread;
use std::time::{Duration, Instant};

use anyhow::{Context, bail};

use super::{Answer, NoOrder, Order, Request};

/// No order is longer.
const LONGEST_ORDER: usize = 64;
/// Of an answer this much is read: more than the list of the cables of 1000 drives.
const LONGEST_ANSWER: u64 = 256 * 1024;

/// How long the server waits for an order on a connection, or for its answer to be taken.
const CLIENT_PATIENCE: Duration = Duration::from_secs(1);
/// How long an order may take to be carried out.
const ORDER_LIMIT: Duration = Duration::from_secs(2);
/// How long a client waits for an answer: others may be before it.
const ANSWER_LIMIT: Duration = Duration::from_secs(10);

/// The server's end: a thread takes orders, one connection after the other. The file is removed in the end.
#[derive(Debug)]
pub struct ControlSocket {
    path: PathBuf,
    /// Device and number of the file, lest another server's be removed.
    file: Option<(u64, u64)>,
    requests: Receiver<Request>,
    stop: Arc<AtomicBool>,
}

impl ControlSocket {
    /// Takes orders at `path`. A socket that an earlier server has left behind there is replaced, nothing else is.
    ///
    /// # Errors
    /// Something else is there, or no socket can be made there.
    pub fn bind(path: &Path) -> anyhow::Result<Self> {
        clear(path)?;
        let listener = UnixListener::bind(path).with_context(|| format!("cannot make the control socket {}", path.display()))?;
        // One at a time: each waits for its answer.
        let (sender, requests) = sync_channel(1);
        let stop = Arc::new(AtomicBool::new(false));
        let stopped = Arc::clone(&stop);
        thread::spawn(move || {
            for connection in listener.incoming() {
                if stopped.load(Ordering::Relaxed) {
                    break;
                }
                match connection {
                    // A client that goes away before it has its answer does without it.
                    Ok(connection) => drop(converse(&connection, &sender)),
                    Err(_) => thread::sleep(CLIENT_PATIENCE),
                }
            }
        });
        Ok(Self {
            path: path.into(),
            file: file_at(path),
            requests,
            stop,
        })
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The orders, for [`crate::server::serve_attended`].
    pub const fn requests(&self) -> &Receiver<Request> {
        &self.requests
    }
}

impl Drop for ControlSocket {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
        if self.file.is_some() && file_at(&self.path) == self.file {
            // Wakes the thread, which ends by itself.
            let _ = UnixStream::connect(&self.path);
            let _ = fs::remove_file(&self.path);
        }
    }
}

fn file_at(path: &Path) -> Option<(u64, u64)> {
    fs::symlink_metadata(path).ok().map(|metadata| (metadata.dev(), metadata.ino()))
}

/// Removes a socket on which nobody listens.
fn clear(path: &Path) -> anyhow::Result<()> {
    let Ok(metadata) = fs::symlink_metadata(path) else { return Ok(()) };
    let place = path.display();
    if !metadata.file_type().is_socket() {
        bail!("{place} exists and is no socket; choose another place for the control socket with --control PATH");
    }
    match UnixStream::connect(path) {
        Ok(_) => bail!("another drive server is controlled by {place}; stop it, or choose another place with --control PATH"),
        Err(error) if error.kind() == io::ErrorKind::ConnectionRefused => {
            fs::remove_file(path).with_context(|| format!("cannot replace the old control socket {place}"))
        }
        Err(error) => Err(error).with_context(|| format!("cannot use the control socket {place}")),
    }
}

/// Takes one order and answers it.
fn converse(connection: &UnixStream, requests: &SyncSender<Request>) -> io::Result<()> {
    let answer = match read_order(connection)?.parse() {
        Ok(order) => carry_out(order, requests),
        Err(NoOrder) => Err(NoOrder.to_string()),
    };
    let text = match answer {
        Ok(text) => format!("ok\n{text}"),
        Err(text) => format!("error\n{text}\n"),
    };
    connection.set_write_timeout(Some(CLIENT_PATIENCE))?;
    let mut connection = connection;
    connection.write_all(text.as_bytes())
}

/// The first line that comes, without its end; what is too long or no text is no order.
fn read_order(mut connection: &UnixStream) -> io::Result<String> {
    let deadline = Instant::now() + CLIENT_PATIENCE;
    let (mut bytes, mut length) = ([0; LONGEST_ORDER], 0);
    while length < bytes.len() && !bytes[..length].contains(&b'\n') {
        let left = deadline.saturating_duration_since(Instant::now());
        // Zero would stand for no limit.
        connection.set_read_timeout(Some(left.max(Duration::from_millis(1))))?;
        match connection.read(&mut bytes[length..])? {
            0 => break,
            read => length += read,
        }
    }
    let line = bytes[..length].split(|&byte| byte == b'\n').next().unwrap_or_default();
    Ok(String::from_utf8_lossy(line).into_owned())
}

fn carry_out(order: Order, requests: &SyncSender<Request>) -> Answer {
    let (sender, answer) = sync_channel(1);
    requests
        .try_send(Request::new(order, sender))
        .map_err(|_| "the drives do not take orders".to_owned())?;
    answer
        .recv_timeout(ORDER_LIMIT)
        .unwrap_or_else(|_| Err("the drives have not answered in time".into()))
}

/// The client's end: gives an order to the server at `path` and waits for its answer.
///
/// # Errors
/// There is no server, or it does not answer.
pub fn ask(path: &Path, order: Order) -> anyhow::Result<Answer> {
    let place = path.display();
    let mut connection = UnixStream::connect(path).with_context(|| {
        format!("no drive server takes orders at {place}; start one with: usr2556e run --interface ... --control {place}")
    })?;
    let mut talk = || {
        connection.set_write_timeout(Some(ANSWER_LIMIT))?;
        connection.set_read_timeout(Some(ANSWER_LIMIT))?;
        connection.write_all(format!("{order}\n").as_bytes())?;
        let mut answer = String::new();
        (&connection).take(LONGEST_ANSWER).read_to_string(&mut answer)?;
        io::Result::Ok(answer)
    };
    let answer = talk().with_context(|| format!("the drive server at {place} does not answer"))?;
    match answer.split_once('\n') {
        Some(("ok", text)) => Ok(Ok(text.into())),
        Some(("error", text)) => Ok(Err(text.trim_end().into())),
        _ => bail!("what answers at {place} is no drive server"),
    }
}

#[cfg(test)]
mod tests {
    use std::net::Shutdown;

    use super::*;
    use crate::segment::VirtualSegment;

    /// A server at `path` with two drives, for as long as `client` talks to it.
    fn with_server<T: Send>(path: &Path, client: impl FnOnce() -> T + Send) -> T {
        let socket = ControlSocket::bind(path).unwrap();
        let mut segment = VirtualSegment::of(2);
        thread::scope(|scope| {
            let client = scope.spawn(client);
            while !client.is_finished() {
                if let Ok(request) = socket.requests().recv_timeout(Duration::from_millis(1)) {
                    request.carry_out(&mut segment);
                }
            }
            client.join().unwrap()
        })
    }

    fn place() -> (tempfile::TempDir, PathBuf) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("control");
        (folder, path)
    }

    #[test]
    fn orders_are_answered_and_the_file_goes_with_the_server() {
        let (_folder, path) = place();
        let order = |text: &str| text.parse().unwrap();
        with_server(&path, || {
            assert_eq!(ask(&path, order("cut 2")).unwrap(), Ok(String::new()));
            assert_eq!(ask(&path, order("cut 2")).unwrap(), Err("cable 2 is cut already".into()));
            assert!(ask(&path, order("list")).unwrap().unwrap().ends_with("(drive 1 to drive 2): cut\n"));
        });
        assert!(!path.exists());
        let error = format!("{:#}", ask(&path, order("list")).unwrap_err());
        assert!(error.contains("no drive server takes orders at"), "{error}");
    }

    /// What the server answers to these bytes; nothing, if it hangs up with some of them unread.
    fn answer_to(path: &Path, bytes: &[u8]) -> String {
        let mut connection = UnixStream::connect(path).unwrap();
        let _ = connection.write_all(bytes);
        let _ = connection.shutdown(Shutdown::Write);
        let mut answer = String::new();
        let _ = connection.read_to_string(&mut answer);
        answer
    }

    #[test]
    fn whatever_comes_is_answered_and_the_next_one_served() {
        let (_folder, path) = place();
        with_server(&path, || {
            for bytes in [
                &b""[..],
                b"\n",
                b"cut",
                b"cut 0\n",
                b"\xFF\x00 1\n",
                &[b'9'; 63],
                b"cut 18446744073709551616\n",
            ] {
                assert!(answer_to(&path, bytes).starts_with("error\n"), "{bytes:?}");
            }
            answer_to(&path, &[b'9'; 1_000_000]);
            assert!(answer_to(&path, b"list").starts_with("ok\ncable 1"), "without an end of line");
            assert!(
                answer_to(&path, b"list\ncut 1\n").starts_with("ok\ncable 1"),
                "the first line counts"
            );
            let silent = UnixStream::connect(&path).unwrap();
            assert!(
                answer_to(&path, b"list\n").starts_with("ok\n"),
                "though another connection says nothing"
            );
            drop(silent);
        });
    }

    #[test]
    fn only_a_socket_without_a_server_is_replaced() {
        let (_folder, path) = place();
        drop(UnixListener::bind(&path).unwrap());
        let first = ControlSocket::bind(&path).unwrap();
        let error = ControlSocket::bind(&path).unwrap_err().to_string();
        assert!(error.contains("another drive server"), "{error}");
        drop(first);
        fs::write(&path, "precious").unwrap();
        let error = ControlSocket::bind(&path).unwrap_err().to_string();
        assert!(error.contains("is no socket"), "{error}");
        assert_eq!(fs::read(&path).unwrap(), b"precious");
    }

    #[test]
    fn a_file_that_took_the_place_stays() {
        let (_folder, path) = place();
        let socket = ControlSocket::bind(&path).unwrap();
        fs::remove_file(&path).unwrap();
        fs::write(&path, "precious").unwrap();
        drop(socket);
        assert_eq!(fs::read(&path).unwrap(), b"precious");
    }
}

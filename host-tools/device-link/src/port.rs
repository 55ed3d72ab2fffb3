//! Where a device is: a serial port, the one of the only board that is plugged in, or a TCP socket behind which
//! one is emulated.

use super::stlink::{self, Plugged};
use serialport::{SerialPortInfo, SerialPortType, UsbPortInfo};
use std::fmt;
use std::io::{self, ErrorKind, Read, Write};
use std::net::{TcpStream, ToSocketAddrs};
use std::path::Path;
use std::str::FromStr;
use std::time::Duration;

/// Longest wait of a read for its first byte; then it fails with [`ErrorKind::TimedOut`] or [`ErrorKind::WouldBlock`].
const READ: Duration = Duration::from_millis(20);
/// Longest wait for a socket to be connected.
const CONNECT: Duration = Duration::from_secs(3);

/// The word for [`Address::Auto`].
const AUTO: &str = "auto";

/// A device's address, as it is said on a command line.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum Address {
    /// The serial port of the only board that is plugged in: `auto`.
    Auto,
    /// Name of a serial port: `/dev/ttyACM0`, `COM3`.
    Serial(String),
    /// `HOST:PORT` of a socket.
    Tcp(String),
}

impl FromStr for Address {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let Some(socket) = text.strip_prefix("tcp:") else {
            return match text {
                "" => Err("expected a serial port, auto, or tcp:HOST:PORT".to_owned()),
                AUTO => Ok(Self::Auto),
                name => Ok(Self::Serial(name.to_owned())),
            };
        };
        match socket.rsplit_once(':') {
            Some((host, port)) if !host.is_empty() && port.parse::<u16>().is_ok() => Ok(Self::Tcp(socket.to_owned())),
            _ => Err("expected tcp:HOST:PORT, as tcp:127.0.0.1:4740".to_owned()),
        }
    }
}

impl From<std::net::SocketAddr> for Address {
    fn from(socket: std::net::SocketAddr) -> Self {
        Self::Tcp(socket.to_string())
    }
}

impl fmt::Display for Address {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Auto => f.write_str(AUTO),
            Self::Serial(name) => f.write_str(name),
            Self::Tcp(socket) => write!(f, "tcp:{socket}"),
        }
    }
}

/// An open port. Its reads wait at most some 20 ms.
pub trait Port: Read + Write + Send {}

impl<P: Read + Write + Send> Port for P {}

/// Why a port could not be opened.
#[derive(Debug, thiserror::Error)]
pub enum PortError {
    /// No board is plugged in.
    #[error("no board is plugged in: no serial port here is an ST-Link's; {}", listed(.there))]
    NoBoard {
        /// The ports there are.
        there: Vec<String>,
    },
    /// More than one board is plugged in.
    #[error("{} boards are plugged in, with the ST-Links {}", boards.len(), serials(.boards))]
    Several {
        /// The boards that are plugged in, all of them.
        boards: Vec<Plugged>,
    },
    /// There is none of that name.
    #[error("{port}: there is no such port; {}", listed(.there))]
    Missing {
        /// Name of the port.
        port: String,
        /// The ports that there are, for the message.
        there: Vec<String>,
    },
    /// Somebody else has it.
    #[error("{port}: another program has it open; close that one (a terminal, a monitor) first")]
    Busy {
        /// Name of the port.
        port: String,
    },
    /// The user may not.
    #[error(
        "{port}: you may not open it; on Linux, join the group it belongs to (`sudo usermod -aG dialout $USER`, then log \
         in again)"
    )]
    Forbidden {
        /// Name of the port.
        port: String,
    },
    /// It is none, or it does not work.
    #[error("{port}: cannot be used as a serial port: {reason}; {}", listed(.there))]
    Unusable {
        /// Name of the port.
        port: String,
        /// What the operating system says.
        reason: String,
        /// The ports that there are, for the message.
        there: Vec<String>,
    },
    /// No program listens there.
    #[error("tcp:{socket}: nothing listens there")]
    Nobody {
        /// The socket, as HOST:PORT.
        socket: String,
    },
    /// The host is not known or does not answer.
    #[error("tcp:{socket}: cannot be reached: {error}")]
    Unreachable {
        /// The socket, as HOST:PORT.
        socket: String,
        /// What the operating system says.
        error: io::Error,
    },
}

impl Address {
    /// Where the device is, with the name of the port in the place of [`Self::Auto`].
    ///
    /// # Errors
    /// No board is plugged in, or several are.
    pub fn resolved(&self) -> Result<Self, PortError> {
        match self {
            Self::Auto => Ok(Self::Serial(only(&ports())?)),
            stated => Ok(stated.clone()),
        }
    }

    /// Opens the port; what has already arrived there is still to be read.
    ///
    /// # Errors
    /// See [`PortError`].
    pub fn open(&self) -> Result<Box<dyn Port>, PortError> {
        match self {
            Self::Auto => self.resolved()?.open(),
            Self::Serial(name) => serial(name),
            Self::Tcp(socket) => tcp(socket).map_err(|error| match error.kind() {
                ErrorKind::ConnectionRefused => PortError::Nobody { socket: socket.clone() },
                _ => PortError::Unreachable { socket: socket.clone(), error },
            }),
        }
    }
}

fn serial(name: &str) -> Result<Box<dyn Port>, PortError> {
    let error = match serialport::new(name, protocol::BAUD).timeout(READ).open() {
        Ok(port) => return Ok(Box::new(port)),
        Err(error) => error,
    };
    let port = name.to_owned();
    let missing = cfg!(unix) && !Path::new(name).exists();
    Err(match error.kind() {
        serialport::ErrorKind::Io(ErrorKind::NotFound) => PortError::Missing { port, there: there() },
        serialport::ErrorKind::NoDevice if missing => PortError::Missing { port, there: there() },
        serialport::ErrorKind::Io(ErrorKind::PermissionDenied) => PortError::Forbidden { port },
        serialport::ErrorKind::NoDevice => PortError::Busy { port },
        _ => PortError::Unusable { port, reason: error.to_string(), there: there() },
    })
}

fn tcp(socket: &str) -> io::Result<Box<dyn Port>> {
    let mut last = io::Error::new(ErrorKind::NotFound, "the host has no address");
    for address in socket.to_socket_addrs()? {
        match TcpStream::connect_timeout(&address, CONNECT) {
            Ok(stream) => {
                stream.set_nodelay(true)?;
                stream.set_read_timeout(Some(READ))?;
                return Ok(Box::new(stream));
            }
            Err(error) => last = error,
        }
    }
    Err(last)
}

/// The serial ports of this machine.
fn ports() -> Vec<SerialPortInfo> {
    // Without this folder, as in some containers, serialport 4.10 panics.
    if cfg!(target_os = "linux") && !Path::new("/sys/class/tty").is_dir() {
        return Vec::new();
    }
    serialport::available_ports().unwrap_or_default()
}

/// The port of the only board among those of a machine.
fn only(ports: &[SerialPortInfo]) -> Result<String, PortError> {
    match &stlink::plugged(ports)[..] {
        [board] => Ok(board.port.clone()),
        [] => Err(PortError::NoBoard { there: ports.iter().map(described).collect() }),
        several => Err(PortError::Several { boards: several.to_vec() }),
    }
}

/// The serial ports of this machine, with what is plugged in.
fn there() -> Vec<String> {
    ports().iter().map(described).collect()
}

/// A port's name, with what is plugged in.
fn described(port: &SerialPortInfo) -> String {
    match &port.port_type {
        SerialPortType::UsbPort(UsbPortInfo { product: Some(product), .. }) => {
            format!("{} ({product})", port.port_name)
        }
        _ => port.port_name.clone(),
    }
}

fn serials(boards: &[Plugged]) -> String {
    let named = |board: &Plugged| match &*board.serial {
        "" => format!("at {}", board.port),
        serial => serial.to_owned(),
    };
    boards.iter().map(named).collect::<Vec<_>>().join(", ")
}

fn listed(ports: &[String]) -> String {
    match ports {
        [] => "this machine has no serial port: is the board plugged in?".to_owned(),
        ports => format!("ports there are: {}", ports.join(", ")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn addresses_read_as_they_are_written() {
        for text in ["auto", "/dev/ttyACM0", "COM3", "tcp:127.0.0.1:4444", "tcp:[::1]:4444"] {
            assert_eq!(text.parse::<Address>().unwrap().to_string(), text);
        }
        for text in ["", "tcp:", "tcp:4444", "tcp::4444", "tcp:localhost:", "tcp:localhost:70000"] {
            assert!(text.parse::<Address>().is_err(), "{text}");
        }
    }

    #[test]
    fn a_file_is_no_serial_port() {
        let file = tempfile::NamedTempFile::new().unwrap();
        let address = Address::Serial(file.path().display().to_string());
        assert!(matches!(address.open(), Err(PortError::Unusable { .. })));
    }

    #[test]
    fn where_there_is_none_the_ports_that_there_are_are_named() {
        let refused = only(&[port("/dev/ttyS0", SerialPortType::PciPort)]).unwrap_err().to_string();
        assert!(refused.contains("no board") && refused.contains("/dev/ttyS0"), "{refused}");
        let refused = only(&[]).unwrap_err().to_string();
        assert!(refused.contains("no serial port"), "{refused}");
    }

    #[test]
    fn of_several_boards_none_is_taken_and_each_is_named() {
        let board = |name, serial: &str| {
            // Its fields differ with its features.
            let usb = UsbPortInfo {
                vid: 0x0483,
                pid: 0x374b,
                serial_number: Some(serial.to_owned()),
                manufacturer: None,
                product: None,
            };
            port(name, SerialPortType::UsbPort(usb))
        };
        let (one, other) = (board("COM7", "066A"), board("COM3", "0039"));
        assert_eq!(only(std::slice::from_ref(&one)).unwrap(), "COM7");
        let refused = only(&[one, other]).unwrap_err().to_string();
        assert!(refused.contains("2 boards") && refused.contains("0039, 066A"), "{refused}");
    }

    fn port(name: &str, port_type: SerialPortType) -> SerialPortInfo {
        SerialPortInfo { port_name: name.to_owned(), port_type }
    }
}

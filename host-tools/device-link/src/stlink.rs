//! The boards that are plugged in, by the virtual serial port of an ST-Link, the debug probe that a NUCLEO board
//! carries on it.

use serialport::{SerialPortInfo, SerialPortType};

/// USB vendor number of STMicroelectronics.
const VENDOR: u16 = 0x0483;
/// ST-Links with a serial port: V2-1 and V3, as probe-rs lists them. ST's other USB products share the vendor.
const PRODUCTS: [u16; 9] = [0x374a, 0x374b, 0x374e, 0x374f, 0x3752, 0x3753, 0x3754, 0x3755, 0x3757];
/// macOS names each port twice; one that is opened by this name waits for a modem's carrier.
const CALL_IN: &str = "/dev/tty.";

/// A board that is plugged in.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Plugged {
    /// Name of its serial port.
    pub port: String,
    /// Serial number of its ST-Link; empty where the operating system does not say.
    pub serial: String,
}

/// The boards among the ports of a machine, by the names of their ports.
pub fn plugged(ports: &[SerialPortInfo]) -> Vec<Plugged> {
    let mut found: Vec<Plugged> = ports.iter().filter_map(board).collect();
    found.sort_by(|one, other| one.port.cmp(&other.port));
    found
}

fn board(port: &SerialPortInfo) -> Option<Plugged> {
    let SerialPortType::UsbPort(usb) = &port.port_type else { return None };
    let is_one = usb.vid == VENDOR && PRODUCTS.contains(&usb.pid) && !port.port_name.starts_with(CALL_IN);
    is_one.then(|| Plugged { port: port.port_name.clone(), serial: usb.serial_number.clone().unwrap_or_default() })
}

#[cfg(test)]
mod tests {
    use super::*;
    use serialport::UsbPortInfo;

    fn usb(name: &str, vid: u16, pid: u16, serial: Option<&str>) -> SerialPortInfo {
        // Its fields differ with its features.
        let port_type = SerialPortType::UsbPort(UsbPortInfo {
            vid,
            pid,
            serial_number: serial.map(str::to_owned),
            manufacturer: None,
            product: None,
        });
        SerialPortInfo { port_name: name.to_owned(), port_type }
    }

    fn named(port: &str, serial: &str) -> Plugged {
        Plugged { port: port.to_owned(), serial: serial.to_owned() }
    }

    fn built_in(name: &str) -> SerialPortInfo {
        SerialPortInfo { port_name: name.to_owned(), port_type: SerialPortType::PciPort }
    }

    #[test]
    fn a_board_is_found_whatever_else_is_plugged_in() {
        let ports = [
            built_in("/dev/ttyS0"),
            usb("/dev/ttyUSB0", 0x0403, 0x6001, Some("FTDI")),
            // A virtual serial port of some other STM32.
            usb("/dev/ttyACM0", 0x0483, 0x5740, Some("2071")),
            usb("/dev/ttyACM1", 0x0483, 0x374e, Some("0039")),
        ];
        assert_eq!(plugged(&ports), [named("/dev/ttyACM1", "0039")]);
        let twice = ["/dev/tty.usbmodem1", "/dev/cu.usbmodem1"].map(|name| usb(name, 0x0483, 0x374b, Some("066A")));
        assert_eq!(plugged(&twice), [named("/dev/cu.usbmodem1", "066A")]);
    }

    #[test]
    fn of_several_each_is_found() {
        let ports = [usb("COM7", 0x0483, 0x374b, None), usb("COM3", 0x0483, 0x374e, Some("0039"))];
        assert_eq!(plugged(&ports), [named("COM3", "0039"), named("COM7", "")]);
    }
}

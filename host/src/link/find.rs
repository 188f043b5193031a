//! `--board auto`: the board among the serial ports of this computer.

use serialport::SerialPortType;

/// USB numbers of the board's own port (CDC-ACM).
const BOARD: (u16, u16) = (0x1209, 0x0001);

/// STMicroelectronics, and its debug probes that have a virtual serial port: ST-LINK/V2-1 with and without mass storage, and V3.
const ST: u16 = 0x0483;
const ST_LINKS: [u16; 6] = [0x374b, 0x3752, 0x374e, 0x374f, 0x3753, 0x3754];

/// A serial port of this computer.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Port {
    /// Device path.
    pub path: String,
    /// USB vendor and product number, if it is on USB.
    pub usb: Option<(u16, u16)>,
    /// Serial number.
    pub serial: Option<String>,
}

impl std::fmt::Display for Port {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "serial:{} (serial number {})", self.path, self.serial.as_deref().unwrap_or("unknown"))
    }
}

/// There is not just one board.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum FindError {
    /// The system does not list its ports.
    #[error("cannot list the serial ports: {0}")]
    NoList(String),
    /// None is plugged in, or none is seen.
    #[error(
        "no board found: no serial port has the USB numbers 1209:0001 (the board) or those of an ST-LINK; {}. Is the cable in and a data \
         cable? On Linux see `dmesg`, install firmware/70-palpate.rules and join the group `dialout`; or name the port: \
         --board serial:PATH", listed(.0, "there is no serial port at all", "there are only")
    )]
    None(Vec<Port>),
    /// Which one?
    #[error("{} boards found, name one: {}", .0.len(), listed(.0, "", "--board"))]
    Several(Vec<Port>),
}

fn listed(ports: &[Port], none: &str, some: &str) -> String {
    let names: Vec<String> = ports.iter().map(ToString::to_string).collect();
    if names.is_empty() { none.to_owned() } else { format!("{some} {}", names.join(", ")) }
}

/// The port of the one board among `ports`: its own USB port, else that of its ST-LINK.
///
/// # Errors
/// [`FindError`] when there is none, or more than one of the kind.
pub fn find(ports: &[Port]) -> Result<&Port, FindError> {
    match find_own(ports) {
        Err(FindError::None(_)) => find_uart(ports, None),
        found => found,
    }
}

/// The own USB port of the one board among `ports`.
///
/// # Errors
/// [`FindError`] when there is none, or more than one.
pub fn find_own(ports: &[Port]) -> Result<&Port, FindError> {
    one(ports, |port| port.usb == Some(BOARD))
}

/// The port of the one debug probe among `ports`, or of that with a serial number: the UART of its board.
///
/// # Errors
/// [`FindError`] when there is none, or more than one.
pub fn find_uart<'a>(ports: &'a [Port], probe: Option<&str>) -> Result<&'a Port, FindError> {
    one(ports, |port| is_probe(port) && probe.is_none_or(|serial| port.serial.as_deref() == Some(serial)))
}

fn one(ports: &[Port], is_meant: impl Fn(&Port) -> bool) -> Result<&Port, FindError> {
    let found: Vec<&Port> = ports.iter().filter(|port| is_meant(port)).collect();
    match found[..] {
        [one] => Ok(one),
        [] => Err(FindError::None(ports.to_vec())),
        _ => Err(FindError::Several(found.into_iter().cloned().collect())),
    }
}

fn is_probe(port: &Port) -> bool {
    port.usb.is_some_and(|(vendor, product)| vendor == ST && ST_LINKS.contains(&product))
}

/// The serial ports of this computer.
///
/// # Errors
/// [`FindError::NoList`].
pub fn ports() -> Result<Vec<Port>, FindError> {
    // The library ends the process where this folder is missing, as in some containers.
    if cfg!(target_os = "linux") && !std::path::Path::new("/sys/class/tty").is_dir() {
        return Ok(Vec::new());
    }
    let listed = serialport::available_ports().map_err(|error| FindError::NoList(error.to_string()))?;
    let port = |info: serialport::SerialPortInfo| match info.port_type {
        SerialPortType::UsbPort(usb) => {
            Port { path: info.port_name, usb: Some((usb.vid, usb.pid)), serial: usb.serial_number }
        }
        _ => Port { path: info.port_name, usb: None, serial: None },
    };
    let ports: Vec<Port> = listed.into_iter().map(port).collect();
    Ok(without_twins(ports))
}

/// macOS lists each device twice; the one that does not wait for a carrier is meant.
fn without_twins(ports: Vec<Port>) -> Vec<Port> {
    let twin = |port: &Port| port.path.strip_prefix("/dev/tty.").map(|name| format!("/dev/cu.{name}"));
    let named = |path: &String| ports.iter().any(|port| port.path == *path);
    ports.iter().filter(|port| !twin(port).is_some_and(|path| named(&path))).cloned().collect()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    fn port(path: &str, usb: (u16, u16), serial: &str) -> Port {
        Port { path: path.into(), usb: Some(usb), serial: Some(serial.into()) }
    }

    fn built_in() -> Port {
        Port { path: "/dev/ttyS0".into(), usb: None, serial: None }
    }

    #[test]
    fn the_boards_own_port_goes_before_that_of_its_probe() {
        let probe = port("/dev/ttyACM0", (0x0483, 0x374b), "066BFF");
        let own = port("/dev/ttyACM1", BOARD, "70616c");
        let other = port("/dev/ttyUSB0", (0x0403, 0x6001), "FT1");
        assert_eq!(find(&[built_in(), probe.clone(), other.clone(), own.clone()]), Ok(&own));
        assert_eq!(find(&[other.clone(), probe.clone(), built_in()]), Ok(&probe));
        let both = [own.clone(), probe.clone(), port("/dev/ttyACM2", (0x0483, 0x374e), "0670FF")];
        assert_eq!(find_uart(&both[..2], None), Ok(&probe));
        assert_eq!(find_uart(&both, Some("066BFF")), Ok(&probe));
        assert!(find_uart(&both, None).is_err() && find_uart(&both, Some("0")).is_err());
        assert_eq!(find_own(&both), Ok(&own));
        assert!(find_own(&both[1..]).is_err());
        // A probe of ST without a serial port, and a converter of another maker, are none.
        assert!(find(&[port("/dev/ttyACM0", (0x0483, 0x3748), "1"), other]).is_err());
    }

    #[test]
    fn several_boards_are_listed_with_their_serial_numbers() {
        let ports = [port("/dev/ttyACM0", BOARD, "A1"), port("/dev/ttyACM1", BOARD, "B2"), built_in()];
        assert_eq!(
            find(&ports).unwrap_err().to_string(),
            "2 boards found, name one: --board serial:/dev/ttyACM0 (serial number A1), serial:/dev/ttyACM1 (serial number B2)"
        );
    }

    #[test]
    fn without_a_board_it_says_what_was_looked_for_and_what_helps() {
        let text = find(&[]).unwrap_err().to_string();
        for part in ["1209:0001", "there is no serial port at all", "70-palpate.rules", "dialout", "serial:PATH"] {
            assert!(text.contains(part), "{part}: {text}");
        }
        let text = find(&[built_in()]).unwrap_err().to_string();
        assert!(text.contains("there are only serial:/dev/ttyS0 (serial number unknown)"), "{text}");
    }

    #[test]
    fn a_device_with_two_names_is_one_port() {
        let twins = ["/dev/cu.usbmodem1", "/dev/tty.usbmodem1"].map(|path| port(path, BOARD, "A1"));
        assert_eq!(without_twins(twins.to_vec()), twins[..1]);
        let alone = [port("/dev/tty.usbmodem1", BOARD, "A1")];
        assert_eq!(without_twins(alone.to_vec()), alone);
    }
}

//! The options of the verbs that talk to a device: where it is, and how its flash is written.

use anyhow::Result;
use clap::Args;
use device_link::write::{WriteError, Writing};
use device_link::{Address, Client, LinkError, WriteConsent};
use protocol::Identity;

/// Where the device is.
#[derive(Args, Clone, Debug)]
pub struct PortOption {
    /// Where the device is: a serial port (/dev/ttyACM0, COM3), or tcp:HOST:PORT of an emulated board.
    #[arg(long, value_name = "PORT")]
    pub port: Address,
}

impl PortOption {
    /// Opens the link.
    pub fn connect(&self) -> Result<(Client, Identity)> {
        Ok(Client::connect(&self.port)?)
    }
}

/// How flash is written.
#[derive(Args, Clone, Debug)]
pub struct WriteOptions {
    /// Write although the device is estimating: erasing a page may cost ticks.
    #[arg(long, conflicts_with = "pause")]
    pub while_estimating: bool,
    /// Pause the estimate meanwhile (the DAC goes to its safe value); it then starts anew, from rest.
    #[arg(long)]
    pub pause: bool,
    /// Restart the device afterwards, and check that it has taken effect. This includes --pause.
    #[arg(long)]
    pub reset: bool,
    /// The DAC is unplugged, or plugged where it belongs by the new table: by the one it drives the amplifier, by the other it
    /// shows the displacement.
    #[arg(long)]
    pub rewired: bool,
    /// Check everything and write nothing.
    #[arg(long)]
    pub dry_run: bool,
}

impl WriteOptions {
    /// Writes as asked; returns the identity after the restart, where there was one.
    ///
    /// # Errors
    /// The device is estimating and nothing was said about it, or it fails.
    pub fn write(
        &self,
        client: &mut Client,
        write: impl FnOnce(&mut Client, WriteConsent) -> Result<(), LinkError>,
    ) -> Result<Option<Identity>, WriteError> {
        let &Self { while_estimating, pause, reset, rewired, dry_run } = self;
        Writing { while_estimating, pause, reset, rewired, dry_run }.write(client, write)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::remedy::sentence;
    use device_link::table;
    use device_link::table::to_record;
    use embedded_storage_async::nor_flash::{ErrorType, NorFlash, NorFlashErrorKind, ReadNorFlash};
    use emulator::faults::lose_replies;
    use emulator::{Emulator, FaultyLine, TABLE};
    use parameter_store::RamFlash;
    use protocol::{Mode, TableSource};

    const CAREFUL: WriteOptions =
        WriteOptions { while_estimating: false, pause: false, reset: false, dry_run: false, rewired: false };

    fn erased() -> RamFlash<Vec<u8>> {
        RamFlash::new(vec![0xFF; 4096])
    }

    /// Pushes the device's own table; returns what the device then does, and where its table comes from after a restart.
    fn push(
        options: &WriteOptions,
        flash: impl NorFlash + Send + 'static,
    ) -> (Result<Option<Identity>, WriteError>, TableSource, Mode) {
        let device = Emulator::new().flash(flash).speed(8.0).start().unwrap();
        let (mut client, _) = Client::connect(&device.address().into()).unwrap();
        let record = to_record(&TABLE.admit().unwrap());
        let done = options.write(&mut client, |client, consent| client.push(record, consent));
        let mode = client.health().unwrap().mode;
        (done, client.restart().unwrap().source, mode)
    }

    /// Flash that can be read and no longer written.
    struct Worn(RamFlash<Vec<u8>>);

    impl ErrorType for Worn {
        type Error = NorFlashErrorKind;
    }

    impl ReadNorFlash for Worn {
        const READ_SIZE: usize = RamFlash::<Vec<u8>>::READ_SIZE;

        async fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), NorFlashErrorKind> {
            self.0.read(offset, bytes).await.map_err(|_| NorFlashErrorKind::Other)
        }

        fn capacity(&self) -> usize {
            self.0.capacity()
        }
    }

    impl NorFlash for Worn {
        const WRITE_SIZE: usize = RamFlash::<Vec<u8>>::WRITE_SIZE;
        const ERASE_SIZE: usize = RamFlash::<Vec<u8>>::ERASE_SIZE;

        async fn erase(&mut self, _: u32, _: u32) -> Result<(), NorFlashErrorKind> {
            Err(NorFlashErrorKind::Other)
        }

        async fn write(&mut self, _: u32, _: &[u8]) -> Result<(), NorFlashErrorKind> {
            Err(NorFlashErrorKind::Other)
        }
    }

    #[test]
    fn a_device_that_estimates_is_left_alone_unless_asked() {
        let (done, source, mode) = push(&CAREFUL, erased());
        let complaint = sentence(&done.unwrap_err());
        assert!(complaint.contains("--pause") && complaint.contains("--while-estimating"), "{complaint}");
        assert!(source != TableSource::Stored && mode == Mode::Estimate);
        let asked = [
            WriteOptions { pause: true, ..CAREFUL },
            WriteOptions { while_estimating: true, ..CAREFUL },
            WriteOptions { reset: true, ..CAREFUL },
        ];
        for options in asked {
            let (done, source, mode) = push(&options, erased());
            assert_eq!(done.unwrap().is_some(), options.reset);
            assert!(source == TableSource::Stored && mode == Mode::Estimate, "{options:?}: {source:?} {mode:?}");
        }
    }

    #[test]
    fn a_dry_run_writes_nothing() {
        let (done, source, _) = push(&WriteOptions { dry_run: true, reset: true, ..CAREFUL }, erased());
        assert!(done.unwrap().is_none() && source != TableSource::Stored);
    }

    #[test]
    fn a_push_that_fails_lets_the_device_go_on() {
        let (done, source, mode) = push(&WriteOptions { pause: true, reset: true, ..CAREFUL }, Worn(erased()));
        let complaint = sentence(&done.unwrap_err());
        assert!(complaint.contains("flash reports an error"), "{complaint}");
        assert!(source != TableSource::Stored && mode == Mode::Estimate);
    }

    #[test]
    fn a_device_that_does_not_answer_is_not_said_to_lack_a_table() {
        let device = Emulator::new().start().unwrap();
        let line = FaultyLine::to(device.address(), lose_replies(2..5)).unwrap();
        let (mut client, _) = Client::connect(&line.address().into()).unwrap();
        let complaint = sentence(&table::running(&mut client).unwrap_err());
        assert!(complaint.contains("no answer") && !complaint.contains("piezo push"), "{complaint}");
    }
}

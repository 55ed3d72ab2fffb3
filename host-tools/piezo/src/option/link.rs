//! What the verbs that talk to a device have in common: `--port`, the table to be written, and how flash is written.

use anyhow::{Context, Result, bail, ensure};
use clap::Args;
use device_link::{Address, Anyway, Client, LinkError};
use estimator_core::record::{self, VERSION};
use estimator_core::table::{Board, Misfit};
use estimator_core::{Admitted, Table};
use identification::table_file::TableFile;
use protocol::{Health, Identity, Mode, Record, Refusal, TableSource};
use std::path::Path;

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
    /// Writes as asked, and says what was done; the identity is that after the restart, where there was one.
    ///
    /// # Errors
    /// The device is estimating and nothing was said about it, or it fails.
    pub fn write(
        &self,
        client: &mut Client,
        write: impl FnOnce(&mut Client, Anyway) -> Result<(), LinkError>,
    ) -> Result<Option<Identity>> {
        let pause = self.pause || (self.reset && !self.while_estimating);
        if !pause && !self.while_estimating && estimating(client)? {
            bail!(
                "the device is estimating, and writing flash may cost ticks: --pause interrupts the estimate, --reset \
                 restarts the device after it, --while-estimating writes all the same"
            );
        }
        if self.dry_run {
            return Ok(None);
        }
        if pause {
            client.set_mode(Mode::Pause)?;
        }
        let anyway = Anyway { while_estimating: self.while_estimating, rewired: self.rewired };
        let written = write(client, anyway);
        let resumed = match pause && (written.is_err() || !self.reset) {
            true => client.set_mode(Mode::Estimate),
            false => Ok(()),
        };
        // What went wrong first is what is said.
        written?;
        resumed?;
        if self.reset { Ok(Some(client.restart()?)) } else { Ok(None) }
    }
}

fn estimating(client: &mut Client) -> Result<bool, LinkError> {
    if client.health()?.mode != Mode::Estimate {
        return Ok(false);
    }
    Ok(table(client)?.is_some())
}

/// The table in use and its record; `None` where there is none.
pub fn table(client: &mut Client) -> Result<Option<Record>, LinkError> {
    match client.pull() {
        Ok(record) => Ok(Some(record)),
        Err(LinkError::Refused { refusal, .. }) if *refusal == Refusal::NoTable => Ok(None),
        Err(error) => Err(error),
    }
}

/// The table in use; an error where there is none.
pub fn running_table(client: &mut Client) -> Result<Admitted> {
    let record = table(client)?.context("the device has no table to estimate with; give it one with `piezo push`")?;
    Table::parse(&record).context("the device's table is refused here")
}

/// An error where the device does anything but estimate.
pub fn require_estimating(health: &Health, port: &Address) -> Result<()> {
    ensure!(
        health.mode == Mode::Estimate,
        "{port}: the device {}; make it estimate again: piezo reset --port {port}",
        device_link::words::mode(health.mode)
    );
    Ok(())
}

/// Reads a table to be written to a device: a table.toml, or the record in a table.bin.
pub fn load(path: &Path) -> Result<Admitted> {
    if path.extension().is_none_or(|extension| extension != "bin") {
        return Ok(TableFile::load(path)?.1);
    }
    let bytes = std::fs::read(path).with_context(|| format!("{}: cannot be read", path.display()))?;
    Table::parse(&bytes).with_context(|| format!("{}: is refused", path.display()))
}

/// The checksum of a record as it names a table for people.
pub fn checksum(record: &[u8]) -> String {
    format!("{:08x}", record::checksum(record).unwrap_or(0))
}

/// What a device asks of a table.
///
/// # Errors
/// It reads another format of records.
pub fn board_of(identity: &Identity) -> Result<Board> {
    let found = identity.record_version;
    ensure!(
        found == VERSION,
        "the firmware reads tables of format {found}, this program writes format {VERSION}: build both from the same sources"
    );
    Ok(identity.board_interface())
}

/// Refuses the table of a file that is not for a board, with the command that makes one that is.
pub fn require_fit(table: &Admitted, board: &Board, path: &Path) -> Result<()> {
    let Err(misfit) = table.fits(board) else { return Ok(()) };
    let remedy = match &misfit {
        Misfit::Tick { board_us, .. } => format!("identify with --tick-us {board_us}"),
        Misfit::Converters { table, board } => {
            let scales = [
                ("--adc-full-scale", table.adc_full_scale, board.adc_full_scale),
                ("--dac-full-scale", table.dac_full_scale, board.dac_full_scale),
            ];
            let wrong = scales.iter().filter(|(_, theirs, ours)| theirs != ours);
            let options: String = wrong.map(|(option, _, ours)| format!(" {option} {ours}")).collect();
            format!(
                "piezo emit {}{options} --out FOLDER (and say --adc-span and --dac-span, if you have measured them)",
                path.with_extension("toml").display()
            )
        }
    };
    bail!("{}: {misfit}: {remedy}", path.display())
}

/// Where the table in use comes from, and why not from the store, as the end of a sentence.
pub fn source(source: &TableSource) -> String {
    match source {
        TableSource::Stored => "from the parameter store".to_owned(),
        TableSource::Compiled { reason } => format!("from the firmware image, since {reason}"),
        TableSource::None { stored, compiled } => {
            format!("none, since {stored}, and the firmware image's own is refused: {compiled}")
        }
    }
}

/// Says when frames came damaged, which a sound line does not do.
pub fn note_damage(client: &Client) {
    if client.damaged() > 0 {
        eprintln!("piezo: {} frames came damaged: check the cable and its ground", client.damaged());
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use device_link::table::to_record;
    use embedded_storage_async::nor_flash::{ErrorType, NorFlash, NorFlashErrorKind, ReadNorFlash};
    use emulator::faults::{lose_replies, messages};
    use emulator::{Emulator, FaultyLine, TABLE};
    use parameter_store::RamFlash;
    use protocol::{Reply, ToHost};

    const CAREFUL: WriteOptions =
        WriteOptions { while_estimating: false, pause: false, reset: false, dry_run: false, rewired: false };

    fn erased() -> RamFlash<Vec<u8>> {
        RamFlash::new(vec![0xFF; 4096])
    }

    /// Pushes the device's own table; returns what the device then does, and where its table comes from after a restart.
    fn push(
        options: &WriteOptions,
        flash: impl NorFlash + Send + 'static,
    ) -> (Result<Option<Identity>>, TableSource, Mode) {
        let device = Emulator::new().flash(flash).speed(8.0).start().unwrap();
        let (mut client, _) = Client::connect(&device.address().into()).unwrap();
        let record = to_record(&TABLE.admit().unwrap());
        let done = options.write(&mut client, |client, anyway| client.push(record, anyway));
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
        let complaint = done.unwrap_err().to_string();
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
        let complaint = done.unwrap_err().to_string();
        assert!(complaint.contains("flash reports an error"), "{complaint}");
        assert!(source != TableSource::Stored && mode == Mode::Estimate);
    }

    #[test]
    fn a_device_that_does_not_answer_is_not_said_to_lack_a_table() {
        let device = Emulator::new().start().unwrap();
        let line = FaultyLine::to(device.address(), lose_replies(2..5)).unwrap();
        let (mut client, _) = Client::connect(&line.address().into()).unwrap();
        let complaint = format!("{:#}", running_table(&mut client).unwrap_err());
        assert!(complaint.contains("no answer") && !complaint.contains("piezo push"), "{complaint}");
    }

    #[test]
    fn what_does_not_fit_is_refused_with_the_command_that_makes_it_fit() {
        let device = Emulator::new().start().unwrap();
        let (_, identity) = Client::connect(&device.address().into()).unwrap();
        let (table, board) = (TABLE.admit().unwrap(), board_of(&identity).unwrap());
        let path = Path::new("mine/table.bin");
        require_fit(&table, &board, path).unwrap();
        let refusal = |board: Board| require_fit(&table, &board, path).unwrap_err().to_string();
        let converters = refusal(Board { adc_full_scale: 4095, dac_full_scale: 1023, ..board });
        let command = "piezo emit mine/table.toml --adc-full-scale 4095 --dac-full-scale 1023";
        assert!(converters.contains(command), "{converters}");
        assert!(refusal(Board { tick_us: 100, ..board }).contains("--tick-us 100"));
        let newer = messages(|message| match message {
            ToHost::Reply { to, reply: Reply::Identity(identity) } => {
                let newer = Identity { record_version: identity.record_version + 1, ..identity };
                Some(ToHost::Reply { to, reply: Reply::Identity(newer) })
            }
            other => Some(other),
        });
        let line = FaultyLine::to(device.address(), newer).unwrap();
        let (_, identity) = Client::connect(&line.address().into()).unwrap();
        let complaint = board_of(&identity).unwrap_err().to_string();
        assert!(complaint.contains(&format!("writes format {VERSION}")), "{complaint}");
    }
}

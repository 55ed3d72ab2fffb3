//! Power goes at every flash operation of a push. When it is back, the device runs the old table or the new one, and
//! can be pushed others.

use std::collections::BTreeSet;
use std::mem;

use crate::common::{Bench, push, record, reseeded};
use anyhow::{Result, bail, ensure};
use board_emulator_test::{Contents, FlashKind, FlashOperation, Reset, Stop, Tear, exception};
use estimator_core::Admitted;
use protocol::Reply;

/// Bytes of a flash page.
const PAGE: usize = 2048;

/// What an interrupted operation leaves. A page can be half erased in more ways than a double word half programmed.
fn tears(kind: FlashKind) -> impl Iterator<Item = Tear> {
    let ways = if kind == FlashKind::Erase { 16 } else { 2 };
    [Tear::Before, Tear::After].into_iter().chain((1..=ways).map(Tear::Midst))
}

/// A device, the flash before a push, and what the push does to it.
struct Push {
    bench: Bench,
    before: Contents,
    old: Admitted,
    new: Admitted,
    operations: Vec<FlashOperation>,
}

impl Push {
    /// The first push of a device that is `wanted`; each pushes another table than the one before.
    fn first(wanted: impl Fn(&Self) -> bool) -> Result<Self> {
        let mut bench = Bench::erased()?;
        let old = bench.table()?;
        let mut push = Self { bench, before: Contents::erased(), old, new: old, operations: Vec::new() };
        for seed in 2..60 {
            push.before = push.bench.board.contents().clone();
            push.old = mem::replace(&mut push.new, reseeded(&push.old, seed));
            let done = push.bench.operations();
            push.bench.push(&push.new)?;
            push.operations = push.bench.board.record().flash[done..].to_vec();
            if wanted(&push) {
                return Ok(push);
            }
        }
        bail!("no push is like that")
    }

    /// Whether it erases a page that holds something.
    fn erases_records(&self) -> bool {
        let erases = self.operations.iter().filter(|operation| operation.kind == FlashKind::Erase);
        erases.into_iter().any(|erase| self.before.bytes(erase.address, PAGE) != [0xFF; PAGE])
    }

    fn cut_everywhere(&mut self, name: &str) -> Result<()> {
        let (mut cuts, mut errors, mut lost) = (0, 0, Vec::new());
        for (nth, FlashOperation { kind, .. }) in (1..).zip(self.operations.clone()) {
            for tear in tears(kind) {
                let place = format!("operation {nth}, {kind:?}, {tear:?}");
                self.cut(nth, tear)?;
                let done = self.bench.operations();
                errors += self.back_on(tear)?;
                ensure!(
                    self.bench.operations() == done,
                    "{name}, {place}: a start writes to the flash; cut it there, too"
                );
                cuts += 1;
                lost.extend(self.strange(&place)?);
                let next = reseeded(&self.new, 1000);
                self.bench.push(&next)?;
                self.bench.restart()?;
                ensure!(record(&self.bench.table()?) == record(&next), "{name}, {place}: the next push");
                if kind == FlashKind::Erase {
                    lost.extend(self.goes_on(&place)?);
                }
            }
        }
        let count = self.operations.len();
        println!("{name}: {count} operations, {cuts} cuts; {errors} ECC errors met at starts");
        ensure!(errors > 0, "{name}: no torn double word was ever read");
        ensure!(lost.is_empty(), "{name}: {} times neither table was left: {lost:#?}", lost.len());
        Ok(())
    }

    /// The push, in whose `nth` operation power goes.
    fn cut(&mut self, nth: usize, tear: Tear) -> Result<()> {
        let bench = &mut self.bench;
        *bench.board.contents_mut() = self.before.clone();
        bench.reboot(Reset::PowerOn)?;
        bench.board.cut_power(nth, tear);
        let stop = bench.ask_or_stop(push(&self.new))?;
        ensure!(stop == Err(Stop::PowerCut), "operation {nth}: {stop:?}");
        Ok(())
    }

    /// Power comes back. The flash errors that the device met: one an NMI, and none but of torn double words.
    fn back_on(&mut self, tear: Tear) -> Result<u32> {
        let bench = &mut self.bench;
        let nmis = |bench: &Bench| bench.board.record().services.get(&exception::NMI).map_or(0, Vec::len);
        let before = nmis(bench);
        bench.reboot(Reset::PowerOn)?;
        let health = bench.health()?;
        ensure!(health.flash_errors as usize == nmis(bench) - before, "{tear:?}: {health:?}");
        ensure!(health.last_words.is_none() && health.missed == 0, "{tear:?}: {health:?}");
        ensure!(matches!(tear, Tear::Midst(_)) || health.flash_errors == 0, "{tear:?}: {health:?}");
        Ok(health.flash_errors)
    }

    /// Pushes until two pages have been erased again, without a cut. What goes wrong, if anything.
    fn goes_on(&mut self, place: &str) -> Result<Option<String>> {
        let done = self.bench.operations();
        for k in 1..60 {
            let next = reseeded(&self.new, 1000 + k);
            let reply = self.bench.ask(push(&next))?;
            self.bench.reboot(Reset::Pin)?;
            if reply != Reply::Done || record(&self.bench.table()?) != record(&next) {
                return Ok(Some(format!("{place}, then push {k}: {reply:?}, {:?}", self.bench.identity()?.source)));
            }
            let operations = &self.bench.board.record().flash[done..];
            let erases = operations.iter().filter(|operation| operation.kind == FlashKind::Erase);
            if erases.map(|erase| erase.address).collect::<BTreeSet<_>>().len() == 2 {
                return Ok(None);
            }
        }
        bail!("{place}: sixty pushes do not erase both pages")
    }

    /// What the device runs, if it is neither the old nor the new table.
    fn strange(&mut self, place: &str) -> Result<Option<String>> {
        let found = record(&self.bench.table()?);
        if found == record(&self.old) || found == record(&self.new) {
            return Ok(None);
        }
        Ok(Some(format!("{place}: {:?}", self.bench.identity()?.source)))
    }
}

#[test]
fn in_the_first_push() -> Result<()> {
    Push::first(|_| true)?.cut_everywhere("first push")
}

#[test]
fn in_the_second_push() -> Result<()> {
    Push::first(|push| push.before != Contents::erased())?.cut_everywhere("second push")
}

#[test]
fn in_a_push_that_erases_a_page_of_old_records() -> Result<()> {
    Push::first(Push::erases_records)?.cut_everywhere("push that erases records")
}

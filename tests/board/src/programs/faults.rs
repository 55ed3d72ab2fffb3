//! Faults, and what ends a run.

use anyhow::Result;

use super::{
    BX_LR, COUNTING_HANDLER, FAULT_HANDLER, FLASH, FLASH_CR, KEYS, MAIN, SEEN, SPEED_UP, STAY, TIM6_CLOCK, board,
    ticking, word,
};
use crate::{
    Reset, Stop,
    exception::{HARD_FAULT, TIM6},
};

#[test]
fn faults_come_to_hard_fault_with_the_instructions_address_and_ram_survives_the_reset() -> Result<()> {
    // r2 = 0x6000_0000, where nothing is; then the culprit.
    let at = FLASH + MAIN + 4;
    for (culprit, pc, status, address) in [
        (0x6813, at, 0x8200, Some(0x6000_0000)),
        (0x6013, at, 0x8200, Some(0x6000_0000)),
        (0xDE00, at, 0x1_0000, None),
        (0xBE00, at, 0, None),
        (0x4710, 0x6000_0000, 0x100, None),
    ] {
        let mut board = board(&[], &[0x2203, 0x0752, culprit, STAY], HARD_FAULT, &FAULT_HANDLER);
        assert_eq!(board.run(1e-3)?, Stop::Reset(Reset::Software), "{culprit:#x}");
        assert_eq!((word(&board, SEEN), word(&board, SEEN + 4)), (pc, 0xFFFF_FFE9), "{culprit:#x}");
        let fault = board.record().faults[0];
        assert_eq!((fault.pc, fault.status, fault.address), (pc, status, address), "{culprit:#x}");
        assert_eq!(board.run(1e-3)?, Stop::Reset(Reset::Software), "nothing runs before the reboot");
        let clock = board.clock();
        board.reboot(Reset::Software)?;
        assert_eq!(word(&board, SEEN), pc);
        assert_eq!(board.machine_mut().read(0x4002_1094, 4), 0x1C00_0000, "SFTRST, BORRST, PINRST");
        assert_eq!(board.run(1e-3)?, Stop::Reset(Reset::Software));
        assert!(board.clock() > clock && board.record().faults.len() == 2);
        board.reboot(Reset::PowerOn)?;
        assert_ne!(word(&board, SEEN), pc);
        assert_eq!(board.machine_mut().read(0x4002_1094, 4), 0x0C00_0000);
    }
    Ok(())
}

#[test]
fn a_fault_that_cannot_be_handled_locks_the_core_up() -> Result<()> {
    let undefined = [0xDE00];
    assert_eq!(board(&[], &undefined, HARD_FAULT, &undefined).run(1e-3)?, Stop::Lockup);
    // movs r2, #3; lsls r2, #29; mov sp, r2; an entry has no stack then.
    let no_stack = [0x2203, 0x0752, 0x4695, 0xDE00];
    assert_eq!(board(&[], &no_stack, HARD_FAULT, &FAULT_HANDLER).run(1e-3)?, Stop::Lockup);
    Ok(())
}

#[test]
fn an_unfed_watchdog_resets_and_its_flag_says_so() -> Result<()> {
    let mut board = board(&[(0x4000_3000, 0xCCCC)], &[0xBF30, STAY], HARD_FAULT, &BX_LR);
    assert_eq!(board.run(1.0)?, Stop::Reset(Reset::Watchdog));
    // 4096 × 4 / 32 kHz = 512 ms
    assert!((board.clock() - SPEED_UP).abs_diff(512 * 170_000) < 20);
    board.reboot(Reset::Watchdog)?;
    assert_eq!(board.machine_mut().read(0x4002_1094, 4), 0x2C00_0000);
    Ok(())
}

#[test]
fn what_the_models_refuse_ends_every_run_until_the_reboot() -> Result<()> {
    // Erases page 0 of bank 1.
    let mut table = KEYS.to_vec();
    table.push((FLASH_CR, 2 | 1 << 16));
    let mut erases_itself = board(&table, &[STAY], HARD_FAULT, &BX_LR);
    for _ in 0..2 {
        let error = format!("{:#}", erases_itself.run(0.1).unwrap_err());
        assert!(error.contains("page 0 of bank 1"), "{error}");
    }
    let mut stores_in_bank_1 = board(&[(FLASH + 0x2000, 0)], &[STAY], HARD_FAULT, &BX_LR);
    let error = format!("{:#}", stores_in_bank_1.run(0.1).unwrap_err());
    assert!(error.contains("read-only 0x8002000"), "{error}");
    Ok(())
}

#[test]
fn a_peripheral_without_its_clock_is_dead() -> Result<()> {
    let mut table = ticking(1000);
    table.retain(|&write| write != TIM6_CLOCK);
    let mut board = board(&table, &[STAY], TIM6, &COUNTING_HANDLER);
    board.run(1e-4)?;
    assert!(board.record().services.is_empty());
    assert_eq!(board.record().unclocked.len(), 3);
    Ok(())
}

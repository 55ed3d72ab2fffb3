//! Interrupts at every place, nested, masked, one after the other; sleep.

use anyhow::Result;
use unicorn_engine::RegisterARM as Register;

use super::{
    AIRCR_IGNORED, BX_LR, COUNTING_HANDLER, FLASH, HANDLER, ISER0, ISPR0, MAIN, SEEN, SPEED_UP, STACK, STAY, board,
    ticking, word,
};
use crate::{Board, Stop, exception::TIM6};

#[test]
fn interrupts_at_every_place_of_an_it_block_cost_their_instructions_and_change_nothing() -> Result<()> {
    // 1: adds r4, #1; tst r4, #1; ite eq; addeq r5, #1; addne r6, #1; nop; b 1b: six counted instructions.
    let main = [0x3401, 0xF014, 0x0F01, 0xBF0C, 0x3501, 0x3601, 0xBF00, 0xE7F7];
    let mut board = board(&ticking(997), &main, TIM6, &COUNTING_HANDLER);
    for (register, value) in [(Register::R4, 0), (Register::R5, 0), (Register::R6, 0)] {
        board.cpu.chip.reg_write(register, value)?;
    }
    board.cpu.chip.mem_write(SEEN.into(), &[0; 4])?;
    board.run(0.05)?;
    let [rounds, even, odd] = [Register::R4, Register::R5, Register::R6].map(|r| board.cpu.register(r).unwrap());
    assert!(rounds.abs_diff(even + odd) <= 1 && even.abs_diff(odd) <= 1, "{rounds} {even} {odd}");
    let services = &board.record().services[&TIM6];
    assert_eq!(services.len(), 8_500_000 / 997);
    assert_eq!(word(&board, SEEN) as usize, services.len());
    assert!(board.instructions(TIM6).all(|own| own == 8));
    let started = services[0].entry / 997 * 997;
    let phases: Vec<u64> = services.iter().map(|s| (s.entry - services[0].entry) % 997).collect();
    assert!(phases.iter().all(|&phase| phase <= 2 || phase >= 995), "an IT block of two delays by no more");
    assert!(started < 1000 && phases.iter().any(|phase| *phase != phases[0]));
    let expected = 6 * u64::from(rounds) + 8 * services.len() as u64;
    let instructions = board.clock() - board.skipped();
    assert!((expected..expected + 80).contains(&instructions), "{instructions} for {expected}");
    Ok(())
}

#[test]
fn sleep_skips_to_the_interrupt_and_events_are_remembered_once() -> Result<()> {
    // sev, and four times wfe; adds r4, #1. The first goes on at once. The second sleeps until the interrupt, whose
    // return is an event for the third. The fourth sleeps.
    let main = [0xBF40, 0xBF20, 0x3401, 0xBF20, 0x3401, 0xBF20, 0x3401, 0xBF20, 0x3401, STAY];
    let mut board = board(&ticking(50_000), &main, TIM6, &COUNTING_HANDLER);
    board.cpu.chip.reg_write(Register::R4, 0)?;
    let passed = |board: &Board| board.cpu.register(Register::R4).unwrap();
    board.run(40_000.0 / 170e6)?;
    assert_eq!(passed(&board), 1);
    board.run(50_000.0 / 170e6)?;
    assert_eq!(passed(&board), 3);
    assert!(board.clock() - board.skipped() < 100, "the core sleeps");
    board.run(50_000.0 / 170e6)?;
    assert_eq!(passed(&board), 4);
    let entries: Vec<u64> = board.record().services[&TIM6].iter().map(|service| service.entry).collect();
    assert_eq!(entries[1] - entries[0], 50_000);
    Ok(())
}

#[test]
fn a_nested_handler_is_not_counted_to_the_one_it_interrupts_and_the_stack_is_aligned() -> Result<()> {
    // sub sp, #4; str r3, [r4]: pends interrupt 3; b .
    let main = [0xB081, 0x6023, STAY];
    // movs r0, #200; 1: subs r0, #1; bne 1b; bx lr: 402 instructions.
    let long = [0x20C8, 0x3801, 0xD1FD, 0x4770];
    let (address, outer) = (FLASH + MAIN + 0x100, 16 + 3);
    let mut table = ticking(100);
    table.extend([(ISER0, 1 << 3), (0xE000_E400, 0x8000_0000)]);
    let mut board = board(&table, &main, TIM6, &COUNTING_HANDLER);
    let code: Vec<u8> = long.iter().flat_map(|half: &u16| half.to_le_bytes()).collect();
    board.cpu.chip.mem_write(address.into(), &code)?;
    board.cpu.chip.mem_write((FLASH + 4 * u32::from(outer)).into(), &(address | 1).to_le_bytes())?;
    board.cpu.chip.reg_write(Register::R3, 1 << 3)?;
    board.cpu.chip.reg_write(Register::R4, ISPR0.into())?;
    let nested = |board: &Board| board.cpu.handlers.len() == 2;
    assert_eq!(board.run_until(1e-5, nested)?, Stop::Condition);
    assert_eq!(board.cpu.register(Register::SP)? % 8, 0);
    board.run(1e-4)?;
    assert_eq!(board.run_until(1e-5, |board| board.cpu.handlers.is_empty())?, Stop::Condition);
    assert_eq!(board.instructions(outer).collect::<Vec<_>>(), [402]);
    assert_eq!(board.cpu.register(Register::SP)?, STACK - 4);
    Ok(())
}

#[test]
fn a_sleep_goes_on_over_the_end_of_a_run() -> Result<()> {
    let mut board = board(&ticking(50_000), &[0xBF30, STAY], TIM6, &COUNTING_HANDLER);
    for _ in 0..10 {
        board.run(1e-5)?;
    }
    assert!(board.clock() - board.skipped() < 60);
    assert_eq!((board.clock(), board.record().services.len()), (SPEED_UP + 17_000, 0));
    Ok(())
}

#[test]
fn masked_interrupts_wait_and_then_follow_each_other_without_unstacking() -> Result<()> {
    // cpsid i; (three nops); str r3, [r4]: pends both; two nops; cpsie i; b .
    let main = [0xB672, 0xBF00, 0xBF00, 0xBF00, 0x6023, 0xBF00, 0xBF00, 0xB662, STAY];
    let (first, second) = (16 + 7, 16 + 3);
    let table = [AIRCR_IGNORED, (ISER0, 1 << 7 | 1 << 3), (0xE000_E400, 0x8000_0000), (0xE000_E404, 0x4000_0000)];
    let image = |exception| board(&table, &main, exception, &BX_LR);
    let mut board = image(first);
    board.cpu.chip.mem_write((FLASH + 4 * u32::from(second)).into(), &((FLASH + HANDLER) | 1).to_le_bytes())?;
    board.cpu.chip.reg_write(Register::R3, 1 << 7 | 1 << 3)?;
    board.cpu.chip.reg_write(Register::R4, ISPR0.into())?;
    board.run(1e-5)?;
    let record = board.record();
    let (early, late) = (record.services[&first][0], record.services[&second][0]);
    // Twelve clocks of entry, one instruction, six clocks from one to the next.
    assert_eq!(late.entry - early.entry, 13);
    assert_eq!(board.skipped(), SPEED_UP + 12 + 6 + 10);
    assert_eq!((early.instructions, late.instructions), (Some(1), Some(1)));
    Ok(())
}

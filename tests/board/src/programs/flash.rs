//! Flash operations, their time, a cut in power, and what reading a torn word does.

use anyhow::Result;
use unicorn_engine::RegisterARM as Register;

use super::{BX_LR, FLASH_CR, KEYS, NMI_HANDLER, PAGE_127, STAY, board};
use crate::{
    FlashKind, Reset, Stop, Tear,
    exception::{HARD_FAULT, NMI},
};

#[test]
fn a_torn_flash_word_is_an_nmi_at_its_reading() -> Result<()> {
    // ldr r3, [r1]; adds r6, #1; b .
    let mut board = board(&[], &[0x6823, 0x3601, STAY], NMI, &NMI_HANDLER);
    board.contents_mut().set(PAGE_127, &[1, 2, 3, 4, 5, 6, 7, 8]);
    board.contents_mut().tear(PAGE_127);
    for (register, value) in [(Register::R4, PAGE_127), (Register::R6, 0), (Register::R7, 0)] {
        board.cpu.chip.reg_write(register, value.into())?;
    }
    board.run(1e-5)?;
    let [value, after, nmis] = [Register::R3, Register::R6, Register::R7].map(|r| board.cpu.register(r).unwrap());
    assert_eq!((value, after, nmis), (0x0403_0201, 1, 1));
    Ok(())
}

/// Erases page 127 and programs its first double word.
fn storing() -> Vec<(u32, u32)> {
    let mut table = KEYS.to_vec();
    table.extend([(FLASH_CR, 2 | 127 << 3 | 1 << 11 | 1 << 16), (FLASH_CR, 1)]);
    table.extend([(PAGE_127, 0x1234_5678), (PAGE_127 + 4, 0x9ABC_DEF0), (FLASH_CR, 0)]);
    table
}

#[test]
fn flash_operations_take_their_time_and_power_goes_in_the_chosen_one() -> Result<()> {
    let new = [0x78, 0x56, 0x34, 0x12, 0xF0, 0xDE, 0xBC, 0x9A];
    let mut whole = board(&storing(), &[STAY], HARD_FAULT, &BX_LR);
    assert_eq!(whole.run(0.03)?, Stop::Time);
    let operations = &whole.record().flash;
    assert_eq!(operations.iter().map(|o| o.kind).collect::<Vec<_>>(), [FlashKind::Erase, FlashKind::Program]);
    assert!((operations[1].clock - operations[0].clock).abs_diff(22_000 * 170) < 30);
    assert_eq!(whole.contents().bytes(PAGE_127, 8), new);

    let old = [0; 8];
    for (nth, tear, expected) in [
        (1, Tear::Before, Some(old)),
        (1, Tear::After, Some([0xFF; 8])),
        (2, Tear::Before, Some([0xFF; 8])),
        (2, Tear::After, Some(new)),
        (2, Tear::Midst(9), None),
    ] {
        let mut board = board(&storing(), &[STAY], HARD_FAULT, &BX_LR);
        board.contents_mut().set(PAGE_127, &old);
        board.cut_power(nth, tear);
        assert_eq!(board.run(0.03)?, Stop::PowerCut);
        assert_eq!(board.record().flash.len(), nth);
        let (_, sound) = board.contents().word(127 * 256);
        assert_eq!(sound.then(|| board.contents().bytes(PAGE_127, 8)), expected.map(Vec::from));
        board.reboot(Reset::PowerOn)?;
        assert_eq!(board.run(0.03)?, Stop::Time, "one cut only");
        assert_eq!(board.contents().bytes(PAGE_127, 8), new);
    }
    Ok(())
}

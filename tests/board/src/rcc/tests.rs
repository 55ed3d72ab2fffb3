//! The clock tree, reset flags and the failing crystal, by the registers alone.

use super::*;

#[test]
fn reset_flags_stay_until_removed_or_power_goes() {
    let flags = |reset, earlier| Rcc::new(reset, earlier).reset_flags();
    let power = flags(Reset::PowerOn, FLAGS);
    assert_eq!(power, 0x0C00_0000);
    let watchdog = flags(Reset::Watchdog, power);
    assert_eq!(watchdog, 0x2C00_0000);
    let mut rcc = Rcc::new(Reset::Software, watchdog);
    rcc.write(CSR, 1);
    assert_eq!(rcc.read(CSR), Some(0x3C00_0003), "LSI on keeps them");
    rcc.write(CSR, RMVF | 1);
    assert_eq!(rcc.read(CSR), Some(3));
}

#[test]
fn a_crystal_that_stops_is_an_nmi_where_it_is_watched_and_the_core_s_end_elsewhere() {
    for watched in [true, false] {
        let mut rcc = Rcc::new(Reset::PowerOn, 0);
        rcc.write(PLLCFGR, 3 | 5 << 4 | 85 << 8 | 1 << 24);
        rcc.write(CR, 0x500 | HSEON | PLLON | if watched { CSSON } else { 0 });
        assert_eq!(rcc.read(CR).map(|value| value & (HSERDY | PLLRDY)), Some(HSERDY | PLLRDY));
        rcc.write(CFGR, 3);
        assert_eq!((rcc.break_crystal(), rcc.crystal_failed()), (watched, watched));
        assert_eq!(rcc.read(CR).map(|value| value & (HSERDY | PLLRDY)), Some(0));
        if watched {
            assert_eq!(rcc.speeds().unwrap(), RESET);
            rcc.write(CICR, CSSF);
            assert!(!rcc.crystal_failed());
        }
    }
}

#[test]
fn the_clock_tree_is_computed() {
    let mut rcc = Rcc::new(Reset::PowerOn, 0);
    assert!(rcc.check_core().is_err(), "HSI16");
    // HSE / 6 × 85, R = 2, P = 5
    rcc.write(PLLCFGR, 3 | 5 << 4 | 85 << 8 | 1 << 24 | 5 << 27);
    rcc.write(CFGR, 3);
    rcc.check_core().unwrap();
    assert!(rcc.adc_hz().is_err());
    rcc.write(CCIPR, 1 << 28);
    assert_eq!(rcc.adc_hz().unwrap(), 68_000_000);
    assert_eq!(rcc.timer_clocks().unwrap(), 1);
    // The core at half, APB1 at half of that; then the core at all and APB1 at a quarter.
    for (dividers, core) in [(8 << 4 | 4 << 8, 85_000_000), (5 << 8, CORE_HZ)] {
        rcc.write(CFGR, 3 | dividers);
        assert_eq!(rcc.speeds().unwrap(), Speeds { system: CORE_HZ, core });
        assert_eq!((rcc.timer_clocks().unwrap(), rcc.check_core().is_ok()), (2, core == CORE_HZ));
    }
}

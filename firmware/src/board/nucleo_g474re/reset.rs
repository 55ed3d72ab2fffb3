//! What the chip says of its last reset.

use embassy_stm32::pac;
use protocol::ResetCause;

/// Why the chip started; clears the flags for the next time.
pub fn cause() -> ResetCause {
    let flags = pac::RCC.csr().read();
    pac::RCC.csr().modify(|w| w.set_rmvf(true));
    let causes = [
        (flags.borrstf(), ResetCause::BROWN_OUT),
        (flags.pinrstf(), ResetCause::PIN),
        (flags.sftrstf(), ResetCause::SOFTWARE),
        (flags.iwdgrstf(), ResetCause::WATCHDOG),
        (flags.oblrstf() || flags.wwdgrstf() || flags.lpwrrstf(), ResetCause::OTHER),
    ];
    causes.into_iter().filter(|(set, _)| *set).map(|(_, cause)| cause).collect()
}

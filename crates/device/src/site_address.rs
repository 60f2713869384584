//! Where the station alias comes from (manual 1.5).

use drive::DriveObjects;
use wire::EscAccess;
use wire::register::{DL_STATUS, STATION_ALIAS};

/// DL status: the slave controller has loaded its EEPROM (ESC data sheet, section II, 2.14).
const EEPROM_LOADED: u16 = 1 << 0;
/// 0x2151: the alias is the EEPROM's, to which masters write it.
const FROM_EEPROM: u16 = 0;

/// The alias, which is settled once after power-on.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct SiteAddress {
    settled: bool,
}

impl SiteAddress {
    /// Settles the alias as soon as the slave controller has loaded its own: with 0x2151 = 1 object 0x2150 replaces that, otherwise 0x2150
    /// shows it.
    pub(crate) fn settle(&mut self, esc: &mut impl EscAccess, objects: &mut DriveObjects) {
        if self.settled || esc.read_u16(DL_STATUS) & EEPROM_LOADED == 0 {
            return;
        }
        self.settled = true;
        if objects.alias_source == FROM_EEPROM {
            objects.alias = esc.read_u16(STATION_ALIAS);
        } else {
            esc.write_u16(STATION_ALIAS, objects.alias);
        }
    }
}

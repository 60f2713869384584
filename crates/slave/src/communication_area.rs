//! The values of objects 0x1000 to 0x1FFF.

use dictionary::{AbortCode, Entry, MAX_VALUE_SIZE, Objects, Value};
use wire::Nanos;

use crate::application::Application;
use crate::configuration::Configuration;
use crate::device_objects::Bytes;
use crate::event_log::{Event, EventLog};
use crate::objects::{
    DEVICE_NAME, DIAGNOSIS_HISTORY, FixedObjects, HARDWARE_VERSION, INPUT_PARAMETERS, OUTPUT_PARAMETERS, RX_ASSIGNMENT, RX_MAPPING,
    SOFTWARE_VERSION, TX_ASSIGNMENT, fixed,
};
use crate::pdo::PdoConfiguration;
use crate::sync_parameters::SyncParameters;

/// The stack's own objects.
#[derive(Clone, Debug)]
pub(crate) struct CommunicationArea {
    /// 0x1600 to 0x1602, 0x1A00 to 0x1A02, 0x1C12, 0x1C13.
    pub(crate) pdo: PdoConfiguration,
    /// 0x1C32.
    pub(crate) outputs: SyncParameters,
    /// 0x1C33.
    pub(crate) inputs: SyncParameters,
    /// What has happened, and 0x10F3.
    pub(crate) log: EventLog,
    fixed: FixedObjects,
    names: [&'static str; 3],
    /// What is added to the stack's time to give 0x10F8.
    timestamp_offset: u64,
}

impl CommunicationArea {
    /// Everything as at delivery.
    pub(crate) fn new(configuration: &Configuration) -> Self {
        let fixed = FixedObjects {
            device_type: configuration.device_type,
            vendor: configuration.identity.vendor,
            product: configuration.identity.product,
            revision: configuration.identity.revision,
            serial: configuration.identity.serial,
            ..FixedObjects::new()
        };
        Self {
            pdo: PdoConfiguration::new(configuration),
            outputs: SyncParameters::outputs(configuration.minimum_cycle_ns, configuration.reaction_ns),
            inputs: SyncParameters::inputs(configuration.minimum_cycle_ns, configuration.reaction_ns),
            log: EventLog::default(),
            fixed,
            names: [
                configuration.device_name,
                configuration.hardware_version,
                configuration.software_version,
            ],
            timestamp_offset: 0,
        }
    }

    /// 0x10F1:02: how far outputs and SYNC0 may fall out of step; 0 switches the check off.
    pub(crate) const fn sync_error_limit(&self) -> u16 {
        self.fixed.sync_error_limit
    }

    /// Both sets of synchronisation parameters, for what they have in common.
    pub(crate) const fn sync_parameters(&mut self) -> [&mut SyncParameters; 2] {
        [&mut self.outputs, &mut self.inputs]
    }

    /// 0x10F8: the device's time.
    pub(crate) const fn device_time(&self, now: Nanos) -> u64 {
        now.0.wrapping_add(self.timestamp_offset)
    }

    /// Copies the value in a slot of [`FixedObjects`] to `out` and returns its size in bytes.
    pub(crate) fn load_fixed(&self, slot: usize, error_register: u8, now: Nanos, out: &mut [u8; MAX_VALUE_SIZE]) -> usize {
        match slot {
            fixed::error_register => error_register.put(out),
            fixed::newest_message => self.log.newest_message().put(out),
            fixed::acknowledged_message => self.log.acknowledged_message().put(out),
            fixed::new_messages => self.log.has_news().put(out),
            fixed::diagnosis_flags => self.log.flags().put(out),
            fixed::timestamp => self.device_time(now).put(out),
            _ => self.fixed.load(slot, out),
        }
    }

    /// Replaces the value in a slot of [`FixedObjects`].
    pub(crate) fn store_fixed(
        &mut self,
        slot: usize,
        data: &[u8],
        application: &mut impl Application,
        now: Nanos,
    ) -> Result<(), AbortCode> {
        match slot {
            fixed::save_all => {
                command(data).and_then(|()| application.store_parameters())?;
                self.log.add(Event::ParametersSaved);
                Ok(())
            }
            fixed::restore_all => {
                command(data).and_then(|()| application.restore_defaults())?;
                self.log.add(Event::DefaultsRestored);
                Ok(())
            }
            fixed::acknowledged_message => self.log.acknowledge(u8::take(data).ok_or(AbortCode::LengthMismatch)?),
            fixed::diagnosis_flags => self.log.set_flags(u16::take(data).ok_or(AbortCode::LengthMismatch)?),
            fixed::timestamp => {
                let time = u64::take(data).ok_or(AbortCode::LengthMismatch)?;
                self.timestamp_offset = time.wrapping_sub(now.0);
                Ok(())
            }
            _ => self.fixed.store(slot, data),
        }
    }

    /// The value of an entry that is generated beside [`FixedObjects`].
    pub(crate) fn load(&self, entry: &Entry) -> Result<Bytes, AbortCode> {
        let mut out = [0; MAX_VALUE_SIZE];
        let size = match entry.index {
            DEVICE_NAME..=SOFTWARE_VERSION => return Ok(self.name(entry.index)),
            DIAGNOSIS_HISTORY if entry.in_record() => return self.log.message(entry.sub),
            DIAGNOSIS_HISTORY => self.log.highest().put(&mut out),
            RX_MAPPING..0x1C00 | RX_ASSIGNMENT | TX_ASSIGNMENT => self.pdo.load(entry.index, entry.sub, &mut out)?,
            OUTPUT_PARAMETERS => self.outputs.load(entry.sub, &mut out),
            INPUT_PARAMETERS => self.inputs.load(entry.sub, &mut out),
            _ => return Err(AbortCode::ObjectNotFound),
        };
        Bytes::from_slice(&out[..size]).map_err(|_| AbortCode::ObjectTooLong)
    }

    /// Replaces the value of an entry that is generated beside [`FixedObjects`].
    pub(crate) fn store(&mut self, entry: &Entry, data: &[u8], application: &'static [Entry]) -> Result<(), AbortCode> {
        match entry.index {
            OUTPUT_PARAMETERS => self.outputs.store(entry.sub, data),
            INPUT_PARAMETERS => self.inputs.store(entry.sub, data),
            _ => self.pdo.store(entry.index, entry.sub, data, application),
        }
    }

    fn name(&self, index: u16) -> Bytes {
        let [device, hardware, software] = self.names;
        let name = match index {
            DEVICE_NAME => device,
            HARDWARE_VERSION => hardware,
            _ => software,
        };
        // Configuration::assert_valid has seen to it that names fit.
        Bytes::from_slice(name.as_bytes()).unwrap_or_default()
    }
}

/// Whether `data` is the value 1, on which 0x1010:01 and 0x1011:01 act.
fn command(data: &[u8]) -> Result<(), AbortCode> {
    match u16::take(data) {
        Some(1) => Ok(()),
        Some(_) => Err(AbortCode::ValueRange),
        None => Err(AbortCode::LengthMismatch),
    }
}

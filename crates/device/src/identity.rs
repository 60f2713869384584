//! Who the device is: the one table behind 0x1008-0x100A, 0x1018, the SII and the ESI.

/// Vendor ID of Shenzhen Rtelligent Technology, assigned by the EtherCAT Technology Group.
pub const VENDOR: u32 = 0x0000_0A88;
/// Name of the vendor.
pub const VENDOR_NAME: &str = "Shenzhen Rtelligent Technology Co.,Ltd.";
/// Product code of the ECR60 family, as which the drive presents itself (manual 2.1.2).
pub const PRODUCT: u32 = 0x0A88_0001;
/// Revision: that of manual V204.
pub const REVISION: u32 = 0x0000_0204;
/// The name in ESI and SII.
pub const NAME: &str = "USR2556E";
/// The group of devices in ESI and SII.
pub const GROUP: &str = "Stepper Driver";
/// 0x1008 (manual 2.1.2).
pub const DEVICE_NAME: &str = "ECR60";
/// 0x1009 (manual 2.1.3).
pub const HARDWARE_VERSION: &str = "A1";
/// 0x100A (manual 2.1.4).
pub const SOFTWARE_VERSION: &str = "101B";
/// 0x1000: device profile 402, stepper drive (manual 2.1.1).
pub const DEVICE_TYPE: u32 = 0x0004_0192;

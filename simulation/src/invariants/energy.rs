//! The bus and the energy: nothing comes from nowhere.

use plant::EnergyAccount;

use super::{TICK, Verdict, View, must};

/// Ticks of a balance.
const PERIOD: u32 = 997;
/// The share of what has moved that the integration may be wrong by, and an energy in J.
const CLOSES: (f64, f64) = (2e-3, 1e-4);

/// The account as it was.
#[derive(Clone, Debug, Default)]
pub struct Energy {
    ticks: u32,
    before: Option<EnergyAccount>,
    /// Energy in the windings' field, and how much has gone in and out of it since then.
    magnetic: (f64, f64),
    /// The account when the bus was last no higher than the source.
    level: Option<EnergyAccount>,
    /// As [`Energy::rounded`], since then.
    rounded_since_level: f64,
    /// Whether a winding was shorted since the balance before: its time constant is about a tick, and the integration no more than stable.
    shorted: bool,
    /// Whether there were currents in the tick before.
    flowed: bool,
    /// What diodes and friction may have lost or won since then, in J.
    rounded: f64,
}

impl Energy {
    /// Looks at a tick.
    ///
    /// # Errors
    /// What does not hold.
    pub fn tick(&mut self, view: &View) -> Verdict {
        let flows = view.plant().motor().currents != [0.0; 2];
        let diodes = if flows || self.flowed { diodes(view) } else { 0.0 };
        self.flowed = flows;
        let rounded = diodes + friction(view);
        self.rounded += rounded;
        self.rounded_since_level += rounded;
        let shorted = view.plant().faults().shorted;
        self.shorted |= shorted[0] || shorted[1];
        let account = view.plant().energy();
        let (magnetic, swung) = self.magnetic;
        self.magnetic = (account.magnetic, swung + (account.magnetic - magnetic).abs());
        self.check_bus(&account, view)?;
        self.ticks += 1;
        if self.ticks < PERIOD {
            return Ok(());
        }
        self.ticks = 0;
        let swung = std::mem::take(&mut self.magnetic.1);
        let Some(before) = self.before.replace(account) else {
            return Ok(());
        };
        let came = account.source + account.hand - before.source - before.hand;
        let went = account.stored() + account.spent() - before.stored() - before.spent();
        let moved = [
            account.source - before.source,
            account.hand - before.hand,
            account.heat - before.heat,
            account.drag - before.drag,
            account.friction - before.friction,
            account.load - before.load,
            account.kinetic - before.kinetic,
        ];
        let moved = swung + moved.iter().map(|energy| energy.abs()).sum::<f64>();
        let rounded = std::mem::take(&mut self.rounded);
        if std::mem::take(&mut self.shorted) {
            return Ok(());
        }
        must((came - went).abs() <= CLOSES.0 * moved + CLOSES.1 + rounded, || {
            format!("{came} J came and {went} J went, of {moved} J moved")
        })
    }

    /// A bus above its source has that from what turned, swung or flowed when it was not, or from the load: the source's diode is closed.
    fn check_bus(&mut self, account: &EnergyAccount, view: &View) -> Verdict {
        let plant = view.plant();
        let config = plant.config();
        let source = f64::from(config.supply.0 + plant.faults().supply_offset.0) / 1000.0;
        if self.shorted {
            self.level = None;
            return Ok(());
        }
        if plant.bus_voltage() <= source {
            self.level = Some(*account);
            self.rounded_since_level = 0.0;
            return Ok(());
        }
        let Some(level) = self.level else { return Ok(()) };
        let stored = |account: &EnergyAccount| account.kinetic + account.elastic + account.magnetic + account.capacitor;
        let brought = account.source - level.source + account.hand - level.hand - (account.load - level.load);
        let gained = stored(account) - stored(&level);
        let tolerance = CLOSES.0 * (stored(&level) + brought.abs() + account.spent() - level.spent()) + CLOSES.1 + self.rounded_since_level;
        must(gained <= brought + tolerance, || {
            format!("the bus at {:.2} V has gained {gained} J of {brought} J", plant.bus_voltage())
        })
    }
}

/// What the torque of currents that diodes carry may be wrong by in a tick, in J: they end somewhere in the tick, which the integration
/// sees at its end only. Until then they change by the bus and the back-EMF over the inductance, and the back-EMF does the work.
fn diodes(view: &View) -> f64 {
    let plant = view.plant();
    if view.is_powered() {
        return 0.0;
    }
    let motor = &plant.config().motor;
    let emf = motor.back_emf * plant.motor().speed.abs();
    2.0 * emf * (plant.bus_voltage() + emf) / motor.inductance * TICK * TICK
}

/// What Coulomb friction may be wrong by in a tick, in J: it is taken off at the end of a tick, so that what the other torques have added to
/// the speed until then was without it.
pub fn friction(view: &View) -> f64 {
    let plant = view.plant();
    let (motor, load) = (&plant.config().motor, &plant.config().load);
    let (magnetic, coupled) = (plant.torque().abs(), plant.load_torque().abs());
    let lost = |friction: f64, torque: f64, inertia: f64| 0.5 * friction * (torque + friction) * TICK * TICK / inertia;
    match load.coupling {
        None => lost(motor.friction + load.friction, magnetic + coupled, motor.inertia + load.inertia),
        Some(_) => {
            let of_load = lost(load.friction, coupled + load.torque.abs(), load.inertia.max(0.1 * motor.inertia));
            lost(motor.friction, magnetic + coupled, motor.inertia) + of_load
        }
    }
}

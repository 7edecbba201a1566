#pragma once

/// Tells when a battery is low.
class BatteryMonitor {
public:
  void setMinVoltage(double volts);
  void setMaxVoltage(double volts);
  void setPatience(int samples);
  void setRecovery(double volts) { m_recovery = volts; }

  void update(double volts);
  bool isLow() const { return m_low; }

private:
  double m_minVoltage = 0.0;
  double m_maxVoltage = 9.5;
  double m_recovery = 0.0;
  int m_patience = 1;
  int m_lowSamples = 0;
  bool m_low = false;
};

// The class that keeps and compares what the setters were given.
#include "battery_monitor.h"
#include <cstdio>

void BatteryMonitor::setMinVoltage(double volts) { m_minVoltage = volts; }

void BatteryMonitor::setMaxVoltage(double volts) {
  std::printf("a maximum of %g is asked for, 9.5 is built in\n", volts);
  m_maxVoltage = 9.5;
}

void BatteryMonitor::setPatience(int samples) { this->m_patience = samples; }

void BatteryMonitor::update(double volts) {
  if (volts > m_maxVoltage)
    return;
  if (volts < m_minVoltage) {
    if (++m_lowSamples >= m_patience)
      m_low = true;
  } else {
    m_lowSamples = 0;
    if (volts > m_recovery)
      m_low = false;
  }
}

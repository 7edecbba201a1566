#pragma once

/// Publishes on "late" when more than the parameter watch/patience has passed.
void watch(double seconds);

#include <dozen_tested/doubler.h>
#include <gtest/gtest.h>

TEST(Doubler, doubles) { EXPECT_EQ(7.0, Doubler::twice(3.5)); }

TEST(Doubler, refusesWhatIsTooMuch) {
  Doubler doubler(6);
  EXPECT_TRUE(doubler.offer(3));
  EXPECT_FALSE(doubler.offer(3.5));
}

int main(int argc, char **argv) {
  testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}

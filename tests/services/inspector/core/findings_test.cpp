#include "services/inspector/core/findings.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace thalweg::inspector {
namespace {

const std::vector<Finding> kOneOfEach = {{Level::kOk, "version", "all of 1.2.3"},
                                         {Level::kNote, "disk", "1.0 GB free in runs", "df -h runs"},
                                         {Level::kProblem, "domain", "it is full", "choose another"}};

TEST(Findings, ForPeopleAreALineEachWithTheirAdviceBelow) {
  const std::string indent(24, ' ');
  EXPECT_EQ(FindingsText(kOneOfEach, false),
            "ok       version         all of 1.2.3\n"
            "note     disk            1.0 GB free in runs\n" +
                indent +
                " -> df -h runs\n"
                "problem  domain          it is full\n" +
                indent +
                " -> choose another\n"
                "1 problem, 1 note\n");
}

TEST(Findings, WhatIsOkIsLeftOutWhereThatIsAskedFor) {
  EXPECT_EQ(FindingsText(kOneOfEach, true).find("version"), std::string::npos);
  EXPECT_NE(FindingsText(kOneOfEach, true).find("disk"), std::string::npos);
  EXPECT_EQ(FindingsText({kOneOfEach[0]}, true), "0 problems, 0 notes\n");
}

TEST(Findings, AsJsonHaveAllThatIsKnownInTheSameOrder) {
  const std::string text = FindingsJson(kOneOfEach);
  EXPECT_TRUE(text.ends_with("]\n"));
  const nlohmann::json list = nlohmann::json::parse(text);
  ASSERT_EQ(list.size(), kOneOfEach.size());
  for (std::size_t k = 0; k < list.size(); ++k) {
    EXPECT_EQ(list[k]["level"], NameOf(kOneOfEach[k].level));
    EXPECT_EQ(list[k]["subject"], kOneOfEach[k].subject);
    EXPECT_EQ(list[k]["text"], kOneOfEach[k].text);
    EXPECT_EQ(list[k]["advice"], kOneOfEach[k].advice);
  }
  EXPECT_EQ(FindingsJson({}), "[]\n");
}

TEST(Findings, ANoteIsNoProblem) {
  EXPECT_TRUE(HasProblem(kOneOfEach));
  EXPECT_FALSE(HasProblem({kOneOfEach[0], kOneOfEach[1]}));
  EXPECT_FALSE(HasProblem({}));
}

}  // namespace
}  // namespace thalweg::inspector

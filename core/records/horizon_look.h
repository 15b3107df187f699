// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// The search for low objects beside a record, or objects close below the ceiling that the record is on.

#pragma once

#include "base/progress.h"
#include "records/candidate.h"
#include "records/record.h"
#include "transport/world.h"

namespace eclat {

/// Looks along the horizon of `candidate` and lowers the clearances of its record; returns the least distance to what stands
/// apart from its surface, infinity where nothing does. Counts rays in `progress`.
float look_along_horizon(const World& world, const Candidate& candidate, Progress& progress, IrradianceRecord& record);

}  // namespace eclat

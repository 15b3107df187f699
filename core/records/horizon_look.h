// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// The search for low objects beside a record, or objects close below the ceiling that the record is on.

#pragma once

#include "base/progress.h"
#include "records/candidate.h"
#include "records/record.h"
#include "transport/world.h"

namespace eclat {

/// Traces rays along the horizon of `candidate` and lowers the clearances of its record. Returns the least distance to
/// an object that is separate from the candidate's surface, or infinity if there is none. Counts the rays in
/// `progress`.
float look_along_horizon(const World& world, const Candidate& candidate, Progress& progress, IrradianceRecord& record);

}  // namespace eclat

// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// A scene as Python holds it.

#pragma once

#include "transport/lit_scene.h"

namespace eclat {

using CoreScene = LitScene;

}  // namespace eclat

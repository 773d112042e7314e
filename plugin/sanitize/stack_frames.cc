// SPDX-License-Identifier: Apache-2.0
// What mujoco/mjsan.h asks for under the address sanitizer, and a MuJoCo without it does not have.

struct mjData_;

extern "C" {

void mj_markStack(mjData_* d);
void mj_freeStack(mjData_* d);
void mj__markStack(mjData_* d) { mj_markStack(d); }
void mj__freeStack(mjData_* d) { mj_freeStack(d); }

}  // extern "C"

/* engine.h - everything that other folders use of the engine, in one include.
 *
 * Include the headers that make up its interface. A mesh is registered (mesh.h) and
 * becomes an object of a scene (scene.h). The positions of a step are staged there. The
 * step is computed, and returns records (step.h). All else in these folders is private to
 * the engine.
 *
 * Threads: each header says of each function who may call it: [any] thread, or the one
 * that computes, [compute].
 */
#ifndef ENG_ENGINE_H
#define ENG_ENGINE_H

#include "affinity.h" /* the processors of a team */
#include "isa.h"      /* the instruction set that is used */
#include "memory.h"   /* who pays for memory, and how much there may be */
#include "mesh.h"     /* topology and registered positions */
#include "near.h"     /* how near things are at one moment */
#include "parallel.h" /* many items, by several threads */
#include "question.h" /* what is asked, and how it is to be computed */
#include "scene.h"    /* objects, and the positions of the next step */
#include "stage_turning.h" /* objects that turn in it */
#include "step.h"     /* a step and its answer; boxes to be looked at */
#include "trace.h"    /* what threads did, when */

#endif

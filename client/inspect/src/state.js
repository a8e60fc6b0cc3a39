// state.js - what is chosen, and who wants to know when it changes.

/** A store of named values. `set` tells each listener once, with the names that changed. */
export function makeState(initial) {
  const values = { ...initial };
  const listeners = [];
  return {
    values,
    set(changes) {
      const changed = new Set(Object.keys(changes).filter((name) => values[name] !== changes[name]));
      if (changed.size > 0) {
        Object.assign(values, changes);
        for (const { names, call } of listeners) {
          if (names.some((name) => changed.has(name))) {
            call(values, changed);
          }
        }
      }
    },
    /** Call `call(values, changed)` when one of `names` changes; and now. */
    on(names, call) {
      listeners.push({ names, call });
      call(values, new Set(names));
    },
  };
}

import { useStore } from 'zustand';
import type { CommandState } from '../state/command-list.ts';
import type { ViewerStore } from '../state/store.ts';

/** The parts of the state that decide which commands can do anything, as they are now. */
export function useCommandState(store: ViewerStore): CommandState {
  const scene = useStore(store, (state) => state.scene);
  const leftScene = useStore(store, (state) => state.leftScene);
  const past = useStore(store, (state) => state.past);
  const undone = useStore(store, (state) => state.undone);
  return { scene, leftScene, past, undone };
}

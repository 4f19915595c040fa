import { toggleTheme } from '@websplatter/kit/theme';
import type { Viewer } from '../engine/viewer.ts';
import { showPath } from '../navigate/show-path.ts';
import {
  COMMANDS,
  type CommandName,
  type InspectCommand,
  openTool,
  type RunCommand,
  type SelectCommand,
} from '../state/command-list.ts';
import type { InspectTab } from '../state/inspecting.ts';
import type { DockName } from '../state/page.ts';
import { SELECT_TOOLS, type SelectTool } from '../state/selecting.ts';
import { isGpuLost } from '../state/session.ts';
import type { ViewerState, ViewerStore } from '../state/store.ts';
import { viewModeAfter } from '../state/view-mode.ts';
import { controlKey, keyScope, mayMoveCamera } from '../ui/key-scope.ts';
import { withCode } from '../ui/lazy.tsx';

/** Commands of the full interface, which a saved page with only the picture lacks. */
export interface InterfaceCommands {
  /** Opens a file picker; the files are added to the scene. */
  readonly addFiles: () => void;
  /** Starts a walk through the scene, or ends it. */
  readonly walk: () => void;
}

export function createCommands(
  viewer: Viewer,
  store: ViewerStore,
  { addFiles, walk }: InterfaceCommands,
): RunCommand {
  const toggle = (name: DockName) => () =>
    store.setState(({ dock }) => ({ dock: dock === name ? null : name }));
  const selectBy = (tool: SelectTool) =>
    store.setState(({ inspecting }) => ({
      dock: 'inspect',
      inspecting: {
        ...inspecting,
        tab: 'select',
        problem: null,
        selecting: { ...inspecting.selecting, tool, dragged: null },
      },
    }));
  const toggleTool = (name: InspectCommand) => () =>
    store.setState((state) =>
      openTool(state) === name
        ? { dock: null }
        : { dock: 'inspect', inspecting: { ...state.inspecting, tab: FIRST_TABS[name], problem: null } },
    );
  /** Changes the picture; on pages with only the picture there is no undo. */
  const asEdit = (name: string, act: () => void) => {
    if (!store.getState().hasInterface) return act();
    void withCode(
      store,
      () => import('../engine/edit-picture.ts'),
      ({ editPicture }) => editPicture({ viewer, store }, name, act),
    );
  };
  const run: Record<CommandName, () => void> = {
    ...(Object.fromEntries(
      SELECT_TOOLS.map(({ name }) => [`select-${name}`, () => selectBy(name)]),
    ) as Record<SelectCommand, () => void>),
    open: toggle('open'),
    add: addFiles,
    clouds: toggle('clouds'),
    flip: () => asEdit('up axis', () => viewer.camera.toggleFlip()),
    reset: () => asEdit('reset of the view', () => viewer.camera.reset()),
    outside: () => void viewer.scenes.lookFrom('object'),
    inside: () => void viewer.scenes.lookFrom('enclosed'),
    frame: () => void viewer.scenes.frameAll(),
    view: toggle('view'),
    fly: () =>
      void withCode(
        store,
        () => import('../navigate/flight.ts'),
        ({ toggleFlight }) => toggleFlight(viewer, store),
      ),
    walk,
    path: () => showPath(store, !store.getState().isPathVisible),
    annotate: () =>
      store.setState(({ annotating, dock }) => ({
        annotating: { ...annotating, isPlacing: !annotating.isPlacing },
        // Clicks in the picture have another meaning in the panel Inspect.
        dock: dock === 'inspect' ? null : dock,
      })),
    undo: () => {
      const { past, leftScene } = store.getState();
      // Without edits, what can be undone is that another scene took the last one's place.
      if (past.length === 0 && leftScene !== null) leftScene.bringBack();
      else
        void withCode(
          store,
          () => import('../state/make-edit.ts'),
          ({ undoEdit }) => undoEdit(store),
        );
    },
    redo: () =>
      void withCode(
        store,
        () => import('../state/make-edit.ts'),
        ({ redoEdit }) => redoEdit(store),
      ),
    'bring-back': () => store.getState().leftScene?.bringBack(),
    mode: () =>
      void withCode(
        store,
        () => import('../view-modes/set-view-mode.ts'),
        ({ setViewMode }) => setViewMode({ viewer, store }, viewModeAfter(store.getState().viewMode, 1)),
      ),
    inspect: toggleTool('inspect'),
    select: toggleTool('select'),
    measure: toggleTool('measure'),
    crop: toggleTool('crop'),
    hud: () => store.setState(({ isHudVisible }) => ({ isHudVisible: !isHudVisible })),
    accuracy: toggle('accuracy'),
    effects: toggle('effects'),
    save: toggle('save'),
    'save-project': () =>
      void withCode(
        store,
        () => import('../share/project-section.tsx'),
        ({ saveProject }) => void saveProject(viewer, store),
      ),
    link: () =>
      void withCode(
        store,
        () => import('../share/copy-link.ts'),
        ({ copyLink }) => void copyLink(viewer, store),
      ),
    theme: toggleTheme,
    help: () => store.setState(({ isHelpVisible }) => ({ isHelpVisible: !isHelpVisible })),
  };
  return (name) => run[name]();
}

/** The key Home does the same. */
const RESET_KEY = COMMANDS.find(({ name }) => name === 'reset')?.key;

/** The tab that a command opens. */
const FIRST_TABS: Readonly<Record<InspectCommand, InspectTab>> = {
  inspect: 'splat',
  select: 'select',
  measure: 'distance',
  crop: 'crop',
};

/** Handles the whole window's keys; returns a function that stops this. */
export function listenToKeys(viewer: Viewer, store: ViewerStore, run: RunCommand): () => void {
  const onKeyDown = (event: KeyboardEvent) => {
    if ((event.ctrlKey || event.metaKey) && event.key.toLowerCase() === 'k' && !isGpuLost(store.getState())) {
      store.setState({ isHelpVisible: true });
      event.preventDefault();
      return;
    }
    const scope = keyScope(event.target);
    const state = store.getState();
    const { isHelpVisible, status, hasInterface } = state;
    const controlled = controlKey(event);
    const held = controlled && COMMANDS.find(({ key }) => key === controlled);
    if (held && hasInterface && !isHelpVisible && scope !== 'text') {
      run(held.name);
      event.preventDefault();
    }
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    if (event.key === 'Escape') {
      // Escape first closes the open list.
      if (scope === 'open list') return;
      // The page about the lost GPU is on top, and stays.
      if (isGpuLost(state)) event.preventDefault();
      else store.setState(withoutTopmost(state));
      return;
    }
    if (status !== 'running' || scope === 'text' || scope === 'open list') return;
    const isHome = event.key === 'Home' && mayMoveCamera(scope, event.key);
    const pressed = isHome ? RESET_KEY : event.key.toLowerCase();
    const command = COMMANDS.find(({ key, isOfCamera }) => key === pressed && (hasInterface || isOfCamera));
    // A held key repeats, which suits moving but not toggling.
    if (command && !event.repeat && (!isHelpVisible || command.name === 'help')) run(command.name);
    else if (command || isHelpVisible || !mayMoveCamera(scope, event.key)) return;
    else if (!viewer.camera.handleKey(event)) return;
    event.preventDefault();
  };
  window.addEventListener('keydown', onKeyDown);
  return () => window.removeEventListener('keydown', onKeyDown);
}

/** Closes the topmost layer, as Escape does. */
function withoutTopmost(state: ViewerState): Partial<ViewerState> {
  // The dialog closes itself too, but later: until then, keys would go to the help.
  if (state.isHelpVisible) return { isHelpVisible: false };
  if (state.isDroppedVisible) return { isDroppedVisible: false };
  if (state.failure) return { failure: null };
  if (state.warning) return { warning: null };
  if (state.groundPart !== null) return { groundPart: null };
  const { annotating } = state;
  if (annotating.isPlacing || annotating.openIndex !== null)
    return { annotating: { ...annotating, isPlacing: false, openIndex: null } };
  return state.dock === null ? { isPathVisible: false } : { dock: null };
}

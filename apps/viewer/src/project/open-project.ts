import { builtinScenes } from '@websplatter/scenes';
import { hardCaseNameIn, hardCaseScene } from '../engine/link/case-addresses.ts';
import { PLACE_NAME } from '../engine/link/linked-start.ts';
import { localFiles } from '../engine/open/local-files.ts';
import { type SceneSource, titleOf } from '../engine/open/scene-source.ts';
import type { PanelProps } from '../engine/viewer.ts';
import { storyOf } from '../navigate/keep-story.ts';
import { NO_HISTORY } from '../state/history.ts';
import { FieldError } from '../state/json-fields.ts';
import type { ViewerStore } from '../state/store.ts';
import { tellFailure } from '../state/tell-failure.ts';
import { giveWork } from './give-work.ts';
import { rowsIn } from './mask-rows.ts';
import { type ProjectPart, readProject } from './project-file.ts';

/**
 * Opens a project in place of the scene: its files, and all that was made of them. If it cannot be
 * read, the store has a failure and the scene stays.
 */
export async function openProject(file: File, panel: PanelProps): Promise<void> {
  const { store, viewer } = panel;
  const opened = await orFailure(file, store, async () => {
    const project = await readProject(file);
    return { project, sources: project.parts.map(sourceOf) };
  });
  if (!opened) return;
  const { project, sources } = opened;
  const looks = new URLSearchParams(project.view).getAll(PLACE_NAME);
  viewer.scenes.openPlaced(...sources.map((source, place) => ({ source, linkedLook: looks[place] })));
  await loaded(store);
  const parts = viewer.scenes.newest?.parts ?? [];
  const found = sources.map((source) => parts.find((part) => part.source === source));
  // Something else was opened meanwhile, or no file could be read, which the store then says.
  if (found.every((part) => part === undefined)) return;
  const removed = await orFailure(file, store, () => project.readRemoved(rowsIn(found)));
  const isShown = ({ source }: { readonly source: SceneSource }) =>
    viewer.scenes.newest?.parts.some((part) => part.source === source);
  if (!removed || !found.every((part) => !part || isShown(part))) return;
  store.setState(storyOf(new URLSearchParams(project.view), store));
  const keys = found.map((part) => part?.key);
  giveWork(panel, { ...project, removed }, 'opened project', keys);
  // The scene begins as it was saved.
  store.setState(NO_HISTORY);
}

/** The files of a scene for a project: local ones as they are, others by their addresses and names. */
export function projectPart(source: SceneSource): ProjectPart {
  const title = titleOf(source);
  switch (source.kind) {
    case 'builtin':
      return { title, scene: source.scene.name };
    case 'hard-case':
      return { title, scene: hardCaseScene(source.name) };
    case 'url':
      return { title, address: source.url.href };
    case 'file':
      return { title, files: localFiles(source.source) };
  }
}

/** Null if the project cannot be used, which the store then says. */
async function orFailure<T>(file: File, store: ViewerStore, read: () => Promise<T>): Promise<T | null> {
  try {
    return await read();
  } catch (error) {
    tellFailure(store, error, {
      title: `${file.name} cannot be opened`,
      advice: 'Save the project again, or open the files of its scene.',
      isFault: !(error instanceof FieldError),
    });
    return null;
  }
}

function sourceOf(part: ProjectPart, place: number): SceneSource {
  if ('address' in part) return { kind: 'url', url: new URL(part.address) };
  if ('files' in part) {
    const files = part.files.map(({ path, bytes }) => new File([bytes], path.split('/').at(-1) ?? path));
    const source = files.length === 1 ? files[0] : { files, paths: part.files.map(({ path }) => path) };
    return { kind: 'file', name: part.title, source };
  }
  const name = hardCaseNameIn(part.scene);
  if (name !== null) return { kind: 'hard-case', name };
  const scene = builtinScenes.find((each) => each.name === part.scene);
  if (scene) return { kind: 'builtin', scene };
  const known = builtinScenes.map((each) => each.name).join(', ');
  throw new FieldError(`parts[${place}].scene`, part.scene, `one of ${known}`);
}

/** Resolves when no file is being opened. */
function loaded(store: ViewerStore): Promise<void> {
  return new Promise((resolve) => {
    const isLoaded = () => store.getState().load === null;
    if (isLoaded()) return resolve();
    const unsubscribe = store.subscribe(() => {
      if (!isLoaded()) return;
      unsubscribe();
      resolve();
    });
  });
}

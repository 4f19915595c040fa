import { formatByName, isLeadingFile } from '@websplatter/core/formats';
import {
  type FileDropDecision,
  type FoundFile,
  type OpenedFiles,
  PROJECT_ENDING,
  READABLE_FORMATS,
} from './file-drop.ts';

/** Most scenes to open at once: a dropped folder may have thousands. */
const MOST_SCENES = 32;

/** Most names in a notice. */
const MOST_NAMES = 3;

/** SuperSplat's name for the camera and the background of a scene. */
const SETTINGS_NAME = 'settings.json';

/**
 * Opens the project among the files, or every scene of one file or several, with the settings among
 * them.
 */
export function decideFiles(found: readonly FoundFile[]): FileDropDecision {
  const project = found.find(({ path }) => path.toLowerCase().endsWith(PROJECT_ENDING));
  if (project) {
    const others = found.length - 1;
    const notice = others > 0 ? `Only ${project.path} is opened: a project is opened alone.` : null;
    return { opened: [], notice, project: project.file };
  }
  const isSettings = ({ path }: FoundFile) => nameOf(path).toLowerCase() === SETTINGS_NAME;
  const [settings] = found.filter(isSettings).toSorted((a, b) => a.path.length - b.path.length);
  if (!settings) return decideScenes(found);
  const others = found.filter((file) => !isSettings(file));
  const scenes = others.length > 0 ? decideScenes(others) : { opened: [], notice: null };
  return { ...scenes, settings: settings.file };
}

function decideScenes(found: readonly FoundFile[]): FileDropDecision {
  if (found.length === 0)
    return { opened: [], notice: `Nothing that was dropped is a file. Drop ${READABLE_FORMATS}.` };
  if (found.length === 1) return { opened: [alone(found[0])], notice: null };
  const leading = leadingFiles(found);
  const isOfSeveral = (file: FoundFile) => leading.some((lead) => file === lead || isCompanion(file, lead));
  const lone = found.filter((file) => !isOfSeveral(file) && formatByName(nameOf(file.path)));
  if (leading.length === 1 && lone.length === 0)
    return { opened: [sceneOf(leading[0], found)], notice: null };
  const scenes = [
    ...leading.map((lead) =>
      sceneOf(lead, [lead, ...found.filter((file) => file !== lead && isCompanion(file, lead))]),
    ),
    ...lone.map(alone),
  ];
  // The file's content may identify a format that its name does not.
  if (scenes.length === 0) scenes.push(alone(found[0]));
  const opened = distinct(scenes.slice(0, MOST_SCENES));
  return { opened, notice: leftOut(found, opened, scenes.length) };
}

/**
 * Files that open a scene. A file below the folder of another one belongs to it, and is left out.
 */
function leadingFiles(found: readonly FoundFile[]): FoundFile[] {
  const leading = found.filter(({ path }) => isLeadingFile(nameOf(path)));
  return leading.filter((file) =>
    leading.every((other) => other === file || !isInside(folderOf(file.path), folderOf(other.path))),
  );
}

/**
 * Whether `lead` may refer to the file: it lies below `lead`'s folder, or in it and is no scene.
 */
function isCompanion({ path }: FoundFile, lead: FoundFile): boolean {
  const [folder, leadFolder] = [folderOf(path), folderOf(lead.path)];
  if (isInside(folder, leadFolder)) return isLeadingFile(nameOf(path)) || !formatByName(nameOf(path));
  return folder === leadFolder && !formatByName(nameOf(path));
}

/** Whether a folder lies in another one, at any depth. */
function isInside(folder: string, outer: string): boolean {
  return folder !== outer && folder.startsWith(outer);
}

const alone = ({ path, file }: FoundFile): NamedFiles => ({ name: file.name, path, source: file });

function sceneOf(lead: FoundFile, files: readonly FoundFile[]): NamedFiles {
  const source = { files: files.map(({ file }) => file), paths: files.map(({ path }) => path) };
  return { name: lead.path.split('/').at(-2) ?? lead.file.name, path: lead.path, source };
}

interface NamedFiles extends OpenedFiles {
  readonly path: string;
}

/** Scenes with the same name are distinguished by their folders. */
function distinct(scenes: readonly NamedFiles[]): OpenedFiles[] {
  const isOnly = (name: string) => scenes.filter((scene) => scene.name === name).length === 1;
  return scenes.map(({ name, path, source }) => ({ name: isOnly(name) ? name : path, source }));
}

/** The notice that counts files left unopened; null if there are none. */
function leftOut(found: readonly FoundFile[], opened: readonly OpenedFiles[], scenes: number): string | null {
  const files = new Set(opened.flatMap(({ source }) => ('files' in source ? source.files : [source])));
  const left = found.filter(({ file }) => !files.has(file)).map(({ path }) => nameOf(path));
  if (left.length === 0) return null;
  const isOne = left.length === 1;
  const what = `${listed(left)} ${isOne ? 'is' : 'are'} left out`;
  if (scenes > opened.length) return `At most ${MOST_SCENES} scenes are opened at once. ${what}.`;
  return `${what}: ${isOne ? 'its name does' : 'their names do'} not end like a splat file’s.`;
}

/** `a.txt and b.txt`, `a.txt, b.txt, c.txt and 4 other files`. */
function listed(names: readonly string[]): string {
  const isMany = names.length > MOST_NAMES + 1;
  const shown = isMany ? names.slice(0, MOST_NAMES) : names.slice(0, -1);
  const last = isMany ? `${names.length - MOST_NAMES} other files` : names.at(-1);
  return [shown.join(', '), last].filter(Boolean).join(' and ');
}

const nameOf = (path: string) => path.replace(/^.*\//, '');
/** With a slash at the end; empty for the outermost. */
const folderOf = (path: string) => path.slice(0, path.lastIndexOf('/') + 1);

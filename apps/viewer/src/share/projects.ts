import { PROJECT_ENDING } from '../engine/open/file-drop.ts';
import { keptWork } from '../project/kept-work.ts';
import { projectPart } from '../project/open-project.ts';
import { writeProject } from '../project/project-file.ts';
import { FileWork, perViewer, savedName } from './file-work.ts';

/** Saves the scene with all that was made of it as a project, one at a time. */
class Projects extends FileWork {
  /** Writes the file and hands it to the browser. Does nothing without a scene, or while busy. */
  async start(): Promise<void> {
    const { store, viewer } = this;
    const sources = viewer.scenes.newest?.parts.map(({ source }) => source) ?? [];
    if (sources.length === 0 || this.isBusy) return;
    const fileName = savedName(sources, { extension: PROJECT_ENDING });
    const report = (part: number | undefined) =>
      store.setState({ savingProject: { fileName, phase: 'write', part } });
    report(undefined);
    store.setState({ failure: null });
    const project = { ...keptWork(viewer, store.getState()), parts: sources.map(projectPart) };
    await this.run({
      fileName,
      doing: 'Saving',
      make: (signal) => writeProject(project, { signal, onPart: report }),
      failureOf: () => ({
        title: `${fileName} cannot be saved`,
        advice: 'A file of the scene may have been moved or changed: open it again.',
      }),
      onEnd: () => store.setState({ savingProject: null }),
    });
  }
}

/** The viewer's one `Projects`, made at the first call. */
export const projectsOf = perViewer((viewer, store) => new Projects(viewer, store));

import { WRITABLE_FORMATS } from '@websplatter/core/write';
import { useState } from 'react';
import { useStore } from 'zustand';
import { LinkSection } from '../links/link-section.tsx';
import { PictureSection } from '../pictures/picture-section.tsx';
import { Dock } from '../ui/dock.tsx';
import type { PanelProps } from '../viewer/panel-props.ts';
import { type Saving, savesSelection } from './saving.ts';

const PHASES = { read: 'Reading the scene again', write: 'Writing' } as const;

/** A link to the present view, a picture of it, and the scene in another format. */
export function SavePanel({ store, viewer, saving }: PanelProps & { saving: Saving }) {
  const running = useStore(store, (state) => state.saving);
  const canSave = useStore(store, (state) => state.scene?.canSave ?? false);
  const isCropped = useStore(store, (state) => state.inspecting.crop !== null);
  const selecting = useStore(store, (state) => state.inspecting.selecting);
  const isSelection = savesSelection(selecting);
  const [name, setName] = useState(WRITABLE_FORMATS[0].name);
  const chosen = WRITABLE_FORMATS.find((format) => format.name === name) ?? WRITABLE_FORMATS[0];
  return (
    <Dock store={store} name="save" title="Save and share">
      <div className="dock-body">
        <LinkSection store={store} viewer={viewer} />
        <PictureSection store={store} viewer={viewer} />
        <section>
          <h3>Scene</h3>
          <fieldset className="chips" aria-label="Format">
            {WRITABLE_FORMATS.map((format) => (
              <button
                key={format.name}
                type="button"
                className="chip"
                aria-pressed={format === chosen}
                title={format.extension}
                data-testid={`save-${format.name}`}
                onClick={() => setName(format.name)}
              >
                {format.title}
              </button>
            ))}
          </fieldset>
          {selecting.selected.size > 0 && (
            <fieldset className="segments" aria-label="Which splats are saved">
              {[false, true].map((each) => (
                <button
                  key={String(each)}
                  type="button"
                  aria-pressed={isSelection === each}
                  data-testid={each ? 'save-selection' : 'save-all'}
                  onClick={() =>
                    store.setState(({ inspecting }) => ({
                      inspecting: { ...inspecting, selecting: { ...selecting, savesSelection: each } },
                    }))
                  }
                >
                  {each ? 'The selection' : 'All that is left'}
                </button>
              ))}
            </fieldset>
          )}
          {running ? (
            <div className="runner" data-testid="saving">
              <div className="runner-row">
                <p>
                  {PHASES[running.phase]}: {running.fileName}
                </p>
                <button
                  type="button"
                  className="text-button"
                  data-testid="cancel-save"
                  onClick={() => saving.cancel()}
                >
                  Cancel
                </button>
              </div>
              <progress aria-label={`Saving ${running.fileName}`} value={running.part} max={1} />
            </div>
          ) : (
            <div className="runner">
              <p>
                {canSave && isCropped && (
                  <strong data-testid="save-cropped">Only what the crop leaves is saved. </strong>
                )}
                {canSave && (isSelection || selecting.removed.size > 0) && (
                  <strong data-testid="save-edited">
                    {isSelection ? 'Only the selected splats are saved. ' : 'Removed splats are not saved. '}
                  </strong>
                )}
                {canSave
                  ? 'Reads all splats again that are not hidden, without effects, and turns them so that other viewers show them this way up.'
                  : 'There is no file behind this scene.'}
              </p>
              <button
                type="button"
                className="text-button primary"
                disabled={!canSave}
                data-testid="save-file"
                onClick={() => saving.start(chosen)}
              >
                Save {chosen.extension}
              </button>
            </div>
          )}
        </section>
      </div>
    </Dock>
  );
}

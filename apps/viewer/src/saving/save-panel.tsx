import { WRITABLE_FORMATS } from '@websplatter/core/write';
import { useState } from 'react';
import { useStore } from 'zustand';
import { LinkSection } from '../links/link-section.tsx';
import { PictureSection } from '../pictures/picture-section.tsx';
import { Dock } from '../ui/dock.tsx';
import type { PanelProps } from '../viewer/panel-props.ts';
import type { Saving } from './saving.ts';

const PHASES = { read: 'Reading the scene again', write: 'Writing' } as const;

/** A link to what is shown, a picture of it, and the scene in another format. */
export function SavePanel({ store, viewer, saving }: PanelProps & { saving: Saving }) {
  const running = useStore(store, (state) => state.saving);
  const canSave = useStore(store, (state) => state.scene?.canSave ?? false);
  const isCropped = useStore(store, (state) => state.inspecting.crop !== null);
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

import { useStore } from 'zustand';
import type { PanelProps } from '../engine/panel-props.ts';
import { annotationTitle } from '../state/annotating.ts';
import { IconButton, TextButton } from '../ui/controls.tsx';
import { Icon } from '../ui/icon.tsx';
import { openAnnotation, redoAnnotating, removeAnnotation, undoAnnotating } from './annotations.ts';

/** The list of annotations. */
export function AnnotationsForm({ store, viewer, onPlace }: PanelProps & { onPlace: () => void }) {
  const { list, past, undone } = useStore(store, (state) => state.annotating);
  const hasScene = useStore(store, (state) => state.scene !== null);
  return (
    <fieldset className="view-field">
      <legend>Annotations</legend>
      {list.length > 0 && (
        <ol className="annotation-list" data-testid="annotations">
          {list.map((annotation, i) => (
            // biome-ignore lint/suspicious/noArrayIndexKey: titles may be those of several.
            <li key={i} className="spread">
              <TextButton look="plain" onClick={() => openAnnotation({ store, viewer }, i)}>
                <b>{i + 1}</b>
                <span>{annotationTitle(annotation, i)}</span>
              </TextButton>
              <IconButton
                icon="close"
                label={`Remove annotation ${i + 1}`}
                onClick={() => removeAnnotation(store, i)}
              />
            </li>
          ))}
        </ol>
      )}
      <div className="view-actions">
        <TextButton disabled={!hasScene} aria-keyshortcuts="P" testId="annotate" onClick={onPlace}>
          <Icon name="annotate" />
          Place an annotation
        </TextButton>
        {past.length > 0 && (
          <TextButton testId="undo-annotating" onClick={() => undoAnnotating(store)}>
            Undo
          </TextButton>
        )}
        {undone.length > 0 && <TextButton onClick={() => redoAnnotating(store)}>Redo</TextButton>}
      </div>
      <p>Words at a place of the scene, which a click in the picture chooses; kept as views are.</p>
    </fieldset>
  );
}

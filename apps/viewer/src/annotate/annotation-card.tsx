import { IconButton, TextButton } from '@websplatter/kit/controls';
import { type FormEvent, useEffect, useLayoutEffect, useRef, useState } from 'react';
import { useStore } from 'zustand';
import type { PanelProps } from '../engine/viewer.ts';
import { type Annotation, annotationTitle } from '../state/annotating.ts';
import { editAnnotation, openAnnotation, placeAnnotation, removeAnnotation } from './annotations.ts';

/** URLs hold the texts of all annotations. */
const MOST_CHARACTERS = { title: 80, text: 500 } as const;

/** The annotation being read or edited, or instructions for placing one. */
export function AnnotationCard({ store, viewer }: PanelProps) {
  const { list, openIndex, isPlacing } = useStore(store, (state) => state.annotating);
  if (isPlacing) return <PlacingBanner store={store} viewer={viewer} />;
  if (openIndex === null) return null;
  return (
    <Card
      // Remounts the fields for each annotation.
      key={openIndex}
      store={store}
      viewer={viewer}
      annotation={list[openIndex]}
      index={openIndex}
      count={list.length}
    />
  );
}

function PlacingBanner({ store, viewer }: PanelProps) {
  return (
    <div className="panel spread annotation-banner" data-testid="placing">
      <p>{matchMedia('(pointer: coarse)').matches ? 'Tap' : 'Click'} the place to annotate.</p>
      <div className="annotation-actions">
        <TextButton
          testId="annotate-middle"
          onClick={() => void placeAnnotation({ store, viewer }, ...viewer.camera.middle)}
        >
          Middle of the picture
        </TextButton>
        <TextButton look="plain" onClick={() => openAnnotation({ store, viewer }, null)}>
          Cancel <kbd>Esc</kbd>
        </TextButton>
      </div>
    </div>
  );
}

function Card({
  store,
  viewer,
  annotation,
  index,
  count,
}: PanelProps & { annotation: Annotation; index: number; count: number }) {
  const { title, text } = annotation;
  const hasInterface = useStore(store, (state) => state.hasInterface);
  const [isEditing, setEditing] = useState(hasInterface && title === '' && text === '');
  const show = (shown: number | null) => openAnnotation({ store, viewer }, shown);
  return (
    <section
      className="panel annotation-card"
      aria-label={`Annotation ${index + 1} of ${count}`}
      data-testid="annotation"
    >
      <header className="spread">
        <h2 aria-live="polite">{annotationTitle(annotation, index)}</h2>
        <span className="annotation-steps">
          {count > 1 && (
            <>
              <IconButton
                icon="previous"
                label="Previous annotation"
                onClick={() => show((index + count - 1) % count)}
              />
              <span>
                {index + 1} of {count}
              </span>
              <IconButton
                icon="next"
                label="Next annotation"
                testId="next-annotation"
                onClick={() => show((index + 1) % count)}
              />
            </>
          )}
          <IconButton icon="close" label="Close" testId="close-annotation" onClick={() => show(null)} />
        </span>
      </header>
      {isEditing ? (
        <WordsForm
          title={title}
          text={text}
          onWords={(words) => {
            // A closing form may be late: another scene, or an undo, has other annotations by then.
            const { list } = store.getState().annotating;
            if (list[index]?.point === annotation.point) editAnnotation(store, index, words);
          }}
          onDone={() => setEditing(false)}
        />
      ) : (
        text && <p className="annotation-text">{text}</p>
      )}
      {hasInterface && !isEditing && (
        <div className="annotation-actions">
          <TextButton testId="edit-annotation" onClick={() => setEditing(true)}>
            Edit
          </TextButton>
          <TextButton testId="remove-annotation" onClick={() => removeAnnotation(store, index)}>
            Remove
          </TextButton>
        </div>
      )}
    </section>
  );
}

type Words = Pick<Annotation, 'title' | 'text'>;

/**
 * Texts are saved when a field loses the focus, each as one undo step, and when the form goes away
 * with the focus in it: Escape closes the card, and loses no words.
 */
function WordsForm({
  title,
  text,
  onWords,
  onDone,
}: Words & { onWords: (words: Words) => void; onDone: () => void }) {
  const form = useRef<HTMLFormElement>(null);
  const field = useRef<HTMLInputElement>(null);
  const latest = useRef(onWords);
  latest.current = onWords;
  useEffect(() => field.current?.focus(), []);
  useLayoutEffect(() => {
    const closing = form.current!;
    return () => latest.current(wordsIn(closing));
  }, []);
  const takeWords = () => {
    if (form.current) onWords(wordsIn(form.current));
  };
  const onSubmit = (event: FormEvent) => {
    event.preventDefault();
    takeWords();
    onDone();
  };
  return (
    <form ref={form} onSubmit={onSubmit} onBlur={takeWords}>
      <input
        ref={field}
        type="text"
        name="title"
        defaultValue={title}
        maxLength={MOST_CHARACTERS.title}
        placeholder="Title"
        aria-label="Title"
        data-testid="annotation-title"
      />
      <textarea
        name="text"
        rows={3}
        defaultValue={text}
        maxLength={MOST_CHARACTERS.text}
        placeholder="Text"
        aria-label="Text"
        data-testid="annotation-text"
      />
      <button type="submit" className="text-button primary" data-testid="annotation-done">
        Done
      </button>
    </form>
  );
}

function wordsIn(form: HTMLFormElement): Words {
  const fields = new FormData(form);
  return { title: String(fields.get('title')).trim(), text: String(fields.get('text')).trim() };
}

import type { HardCase, RefusedFileCase, CaseVerdict as Verdict } from '@websplatter/conformance';
import { readSplats, SplatFileError } from '@websplatter/core';
import { IconButton } from '@websplatter/kit/controls';
import { groupTitle, isOpenable, noteOn } from '@websplatter/kit/hard-cases';
import { Icon } from '@websplatter/kit/icon';
import { type MouseEvent, useEffect, useRef, useState } from 'react';
import { CaseVerdict, caseAddress, GALLERY, VIEWER } from '../page.tsx';
import { CaseComparison } from './case-comparison.tsx';
import type { CaseImages } from './case-images.ts';
import { hasImage } from './catalogue.ts';

/**
 * The page of one hard case: expected result, this device's result, and links to its neighbours.
 */
export function CasePage({
  hardCase,
  verdict,
  previous,
  next,
  images,
  onGo,
}: {
  hardCase: HardCase;
  /** Of its tests on this device. */
  verdict: Verdict;
  previous: string | null;
  next: string | null;
  images: CaseImages;
  /** Goes to another case; null: to the list of all cases. */
  onGo: (name: string | null) => void;
}) {
  const { name, group, breaks } = hardCase;
  const heading = useRef<HTMLHeadingElement>(null);
  // biome-ignore lint/correctness/useExhaustiveDependencies: another case starts at its top.
  useEffect(() => {
    heading.current?.focus({ preventScroll: true });
    scrollTo(0, 0);
  }, [name]);
  useEffect(() => {
    const onKeyDown = (event: KeyboardEvent) => {
      if (event.ctrlKey || event.metaKey || event.altKey || event.shiftKey) return;
      if (event.key === 'ArrowLeft' && previous !== null) onGo(previous);
      else if (event.key === 'ArrowRight' && next !== null) onGo(next);
      else if (event.key === 'Escape') onGo(null);
      else return;
      event.preventDefault();
    };
    window.addEventListener('keydown', onKeyDown);
    return () => window.removeEventListener('keydown', onKeyDown);
  }, [previous, next, onGo]);

  return (
    <main className="case" data-testid="case">
      <header>
        <div className="heading">
          <p className="case-links">
            <a href={GALLERY} onClick={inPlace(() => onGo(null))} data-testid="case-all">
              All hard cases
            </a>
          </p>
          <nav className="case-steps" aria-label="Cases">
            <Step icon="previous" label="Previous case" keyName="ArrowLeft" name={previous} onGo={onGo} />
            <Step icon="next" label="Next case" keyName="ArrowRight" name={next} onGo={onGo} />
          </nav>
        </div>
        <p data-testid="case-group">{groupTitle(group)}</p>
        <h1 ref={heading} tabIndex={-1} data-testid="case-name">
          {name}
        </h1>
        <p>
          Goes wrong elsewhere: <span data-testid="case-breaks">{breaks}</span>
        </p>
      </header>
      <Contents key={name} hardCase={hardCase} images={images} />
      <div className="buttons">
        {isOpenable(hardCase) && (
          <a
            className="text-button primary"
            href={`${VIEWER}?scene=hard:${encodeURIComponent(name)}`}
            data-testid="case-open"
          >
            Open it in the viewer
          </a>
        )}
        <a className="text-button outlined" href={`?conformance&cases=${encodeURIComponent(name)}`}>
          Run its tests on this device
        </a>
        <CaseVerdict verdict={verdict} />
      </div>
    </main>
  );
}

function Contents({ hardCase, images }: { hardCase: HardCase; images: CaseImages }) {
  if (hasImage(hardCase)) return <CaseComparison hardCase={hardCase} images={images} />;
  if (hardCase.kind === 'refused-file') return <RefusedFile hardCase={hardCase} />;
  const note =
    noteOn(hardCase) || 'An image without pixels: there is nothing to show, and nothing must fail.';
  return <p className="note">{note}</p>;
}

function Step(props: {
  icon: 'previous' | 'next';
  label: string;
  keyName: string;
  /** Null at the ends of the list. */
  name: string | null;
  onGo: (name: string) => void;
}) {
  const { icon, label, keyName, name, onGo } = props;
  if (name === null) {
    return <IconButton icon={icon} label={label} disabled testId={`case-${icon}`} />;
  }
  return (
    <a
      className="icon-button"
      href={caseAddress(name)}
      aria-label={`${label}: ${name}`}
      aria-keyshortcuts={keyName}
      title={`${label}: ${name} (${icon === 'next' ? '→' : '←'})`}
      onClick={inPlace(() => onGo(name))}
      data-testid={`case-${icon}`}
    >
      <Icon name={icon} />
    </a>
  );
}

/** Handles a link without reloading the page, unless it is opened in another tab or window. */
export function inPlace(go: () => void): (event: MouseEvent) => void {
  return (event) => {
    if (event.button !== 0 || event.ctrlKey || event.metaKey || event.shiftKey || event.altKey) return;
    event.preventDefault();
    go();
  };
}

/** A file that must be refused: the expected error, and the actual one. */
function RefusedFile({ hardCase }: { hardCase: RefusedFileCase }) {
  const [outcome, setOutcome] = useState<Outcome | null>(null);
  useEffect(() => {
    let isGone = false;
    void readOutcome(hardCase).then((read) => {
      if (!isGone) setOutcome(read);
    });
    return () => {
      isGone = true;
    };
  }, [hardCase]);
  const isAsExpected = outcome?.code === hardCase.code;
  return (
    <dl className="case-facts" data-testid="case-refusal">
      <dt>Expected</dt>
      <dd>
        The file is refused as <code>{hardCase.code}</code>
      </dd>
      <dt>Here</dt>
      <dd className={outcome && !isAsExpected ? 'bad' : ''}>
        {outcome ? (
          <>
            {isAsExpected ? 'Refused as ' : 'Not as expected: '}
            <code>{outcome.code}</code>. {outcome.message}
          </>
        ) : (
          'Reading…'
        )}
      </dd>
    </dl>
  );
}

interface Outcome {
  /** Code of the error, or `read` if there was none. */
  readonly code: string;
  readonly message: string;
}

async function readOutcome({ file, name }: RefusedFileCase): Promise<Outcome> {
  try {
    const { count } = await readSplats(file(), { name });
    return { code: 'read', message: `It was read, with ${count} splats.` };
  } catch (error) {
    const message = error instanceof Error ? error.message : String(error);
    return { code: error instanceof SplatFileError ? error.code : 'other', message };
  }
}

import { HARD_CASES, type HardCase, type KeptRun, keptRun, verdictOn } from '@websplatter/conformance';
import { closestNames } from '@websplatter/kit/hard-cases';
import { useCallback, useEffect, useMemo, useState } from 'react';
import { caseAddress, GALLERY, LabLinks } from '../page.tsx';
import type { CaseImages } from './case-images.ts';
import { CasePage } from './case-page.tsx';
import { filteredCases, neighboursOf } from './catalogue.ts';
import { Gallery } from './gallery.tsx';
import { useCaseImages } from './use-case-images.ts';
import './gallery.css';

/**
 * The gallery of hard cases (`?gallery`, with `&q=` as search) and the page of each case (`&case=`),
 * without page loads in between.
 */
export default function GalleryPage() {
  const [query, setQuery] = useState(() => parameter('q') ?? '');
  const [name, setName] = useState(() => parameter('case'));
  const images = useCaseImages(true);
  const kept = useKeptRun();
  const found = useMemo(() => filteredCases(HARD_CASES, query), [query]);
  const go = useCallback((to: string | null) => {
    history.pushState(null, '', addressWith('case', to));
    setName(to);
  }, []);

  useEffect(() => {
    const onPopState = () => {
      setName(parameter('case'));
      setQuery(parameter('q') ?? '');
    };
    window.addEventListener('popstate', onPopState);
    return () => window.removeEventListener('popstate', onPopState);
  }, []);
  useEffect(() => {
    // The URL restores the same list.
    history.replaceState(history.state, '', addressWith('q', query || null));
  }, [query]);
  useEffect(() => {
    document.title = `${name ?? 'Hard cases'} · WebSplatter lab`;
    document.documentElement.dataset.state = 'ready';
    // After Back from a case, the list is where that case is.
    return () => {
      if (name !== null) requestAnimationFrame(() => entryOf(name)?.focus());
    };
  }, [name]);

  if (!images) return null;
  return (
    <>
      <LabLinks current="gallery" />
      <Gallery
        found={found}
        query={query}
        onQuery={setQuery}
        isHidden={name !== null}
        kept={kept}
        images={images}
        onGo={go}
      />
      {name !== null && <CaseOrNone found={found} name={name} kept={kept} images={images} onGo={go} />}
    </>
  );
}

function CaseOrNone(props: {
  found: readonly HardCase[];
  name: string;
  kept: KeptRun | null;
  images: CaseImages;
  onGo: (name: string | null) => void;
}) {
  const { found, name, kept, images, onGo } = props;
  const hardCase = HARD_CASES.find((candidate) => candidate.name === name);
  if (!hardCase) return <NoCase name={name} />;
  // A linked case that the search does not match has all cases as neighbours.
  const neighbours = neighboursOf(found.includes(hardCase) ? found : HARD_CASES, name);
  return (
    <CasePage
      hardCase={hardCase}
      verdict={verdictOn(name, kept)}
      {...neighbours}
      images={images}
      onGo={onGo}
    />
  );
}

/** Verdicts that this browser keeps; other tabs may add some while the page is open. */
function useKeptRun(): KeptRun | null {
  const [kept, setKept] = useState(() => keptRun());
  useEffect(() => {
    const read = () => setKept(keptRun());
    // Back from a run may show this page as it was left.
    const events = ['storage', 'pageshow'];
    for (const type of events) addEventListener(type, read);
    return () => {
      for (const type of events) removeEventListener(type, read);
    };
  }, []);
  return kept;
}

function NoCase({ name }: { name: string }) {
  const similar = closestNames(
    HARD_CASES.map((candidate) => candidate.name),
    name,
  );
  return (
    <main className="case" data-testid="no-case">
      <header>
        <p className="case-links">
          <a href={GALLERY}>All hard cases</a>
        </p>
        <h1>No such case</h1>
        <p role="alert">
          There is no hard case “{name}”{similar.length > 0 ? '. These have similar names:' : '.'}
        </p>
        <p className="case-links">
          {similar.map((each) => (
            <a key={each} href={caseAddress(each)}>
              {each}
            </a>
          ))}
        </p>
      </header>
    </main>
  );
}

function entryOf(name: string): HTMLElement | null {
  return document.querySelector<HTMLElement>(`[data-case="${CSS.escape(name)}"]`);
}

function parameter(name: 'q' | 'case'): string | null {
  return new URLSearchParams(location.search).get(name);
}

/** The page's URL with one parameter changed; null removes it. */
function addressWith(name: 'q' | 'case', value: string | null): string {
  const address = new URL(location.href);
  if (value === null) address.searchParams.delete(name);
  else address.searchParams.set(name, value);
  // The fragment names a group in the list, so it does not apply to a case.
  if (name === 'case') address.hash = '';
  return address.href;
}

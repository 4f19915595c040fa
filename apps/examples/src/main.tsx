import { StrictMode } from 'react';
import { createRoot } from 'react-dom/client';
import { ExamplePage } from './example-page.tsx';
import { EXAMPLES } from './examples.ts';
import './examples.css';
import { IndexPage } from './index-page.tsx';

const name = new URLSearchParams(location.search).get('example');
const example = EXAMPLES.find((each) => each.name === name);
if (example) document.title = `${example.title} · WebSplatter examples`;

createRoot(document.getElementById('root')!).render(
  <StrictMode>{example ? <ExamplePage example={example} /> : <IndexPage missing={name} />}</StrictMode>,
);

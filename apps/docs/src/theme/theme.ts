import { useRoute, withBase } from 'vitepress';
import DefaultTheme from 'vitepress/theme-without-fonts';
import { defineComponent, h, onMounted, watch } from 'vue';
import './theme.css';
import './playground.css';

/** Adds the `main` landmark, which the theme omits on the first page and on the 404 page. */
function markMain(): void {
  const content = document.getElementById('VPContent');
  if (content?.querySelector('main')) content.removeAttribute('role');
  else content?.setAttribute('role', 'main');
}

/** VitePress's theme with system fonts and this site's custom elements. */
export default {
  extends: DefaultTheme,
  Layout: defineComponent({
    setup() {
      // Runs after hydration: earlier, Vue would report added elements as mismatches.
      onMounted(async () => {
        const kit = new URL(withBase('/kit/'), location.href);
        const [{ definePlayground }, { defineMeasure }] = await Promise.all([
          import('../playground/playground-element.ts'),
          import('../live/measure-element.ts'),
        ]);
        definePlayground(kit);
        defineMeasure(kit);
      });
      // biome-ignore lint/correctness/useHookAtTopLevel: setup of Vue, which knows no such rule.
      const route = useRoute();
      onMounted(markMain);
      watch(() => route.data, markMain, { flush: 'post' });
      return () => h(DefaultTheme.Layout);
    },
  }),
};

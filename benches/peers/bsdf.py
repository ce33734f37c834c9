"""glTF's metallic-roughness surface (glTF 2.0, Appendix B) as a plugin for Mitsuba 3.

Dr.Jit compiles it into the same kernel as Mitsuba's own plugins. It samples visible normals of GGX
or a cosine, chosen by how much each reflects. All numbers are data of the kernel, so that surfaces
share code. It is what dapple does with `--bsdf appendix-b`, down to the least roughness.
"""

LEAST_ALPHA = 1e-3
LEAST_SPECULAR = 0.1


def register():
    """Makes `metallic_roughness` known to Mitsuba's current variant."""
    import drjit as dr
    import mitsuba as mi

    class MetallicRoughness(mi.BSDF):
        def __init__(self, properties):
            mi.BSDF.__init__(self, properties)
            base = [properties[f"base_{channel}"] for channel in "rgb"]
            roughness = properties["roughness"]
            self.base = mi.Color3f(*base)
            self.metallic = mi.Float(properties["metallic"])
            self.alpha = mi.Float(max(roughness * roughness, LEAST_ALPHA))
            self.specular = mi.Float(properties["specular"])
            dr.make_opaque(self.base, self.metallic, self.alpha, self.specular)
            glossy = mi.BSDFFlags.GlossyReflection | mi.BSDFFlags.FrontSide
            diffuse = mi.BSDFFlags.DiffuseReflection | mi.BSDFFlags.FrontSide
            self.m_components = [glossy, diffuse]
            self.m_flags = glossy | diffuse

        def fresnel(self, cosine):
            """Reflectance of the dielectric and of the metal."""
            grazing = (1 - cosine) ** 5
            dielectric = self.specular * (0.04 + 0.96 * grazing)
            return dielectric, self.base + (1 - self.base) * grazing

        def chance(self, cosine):
            """How often the specular part is sampled."""
            dielectric, metal = self.fresnel(cosine)
            specular = dr.lerp(dielectric, mi.luminance(metal), self.metallic)
            diffuse = (1 - self.metallic) * (1 - dielectric) * mi.luminance(self.base)
            share = specular / dr.maximum(specular + diffuse, 1e-8)
            both = dr.clip(share, LEAST_SPECULAR, 1 - LEAST_SPECULAR)
            return dr.select(diffuse > 0, both, 1)

        def eval_pdf(self, context, interaction, wo, active=True):
            wi = interaction.wi
            cos_i, cos_o = mi.Frame3f.cos_theta(wi), mi.Frame3f.cos_theta(wo)
            active &= (cos_i > 0) & (cos_o > 0)
            half = dr.normalize(wi + wo)
            squared = self.alpha * self.alpha
            cos_h = mi.Frame3f.cos_theta(half)
            spread = cos_h * cos_h * (squared - 1) + 1
            density = squared / (dr.pi * spread * spread)
            # Smith's shadowing of one direction, over twice its cosine.
            masks = [1 / (c + dr.sqrt(squared + (1 - squared) * c * c)) for c in (cos_i, cos_o)]
            lobe = density * masks[0] * masks[1]
            dielectric, metal = self.fresnel(dr.dot(wi, half))
            plain = self.base * dr.inv_pi * (1 - dielectric) + lobe * dielectric
            value = dr.lerp(plain, lobe * metal, self.metallic) * cos_o
            chance = self.chance(cos_i)
            pdf = chance * density * masks[0] / 2 + (1 - chance) * cos_o * dr.inv_pi
            return dr.select(active, value, 0), dr.select(active, pdf, 0)

        def eval(self, context, interaction, wo, active=True):
            return self.eval_pdf(context, interaction, wo, active)[0]

        def pdf(self, context, interaction, wo, active=True):
            return self.eval_pdf(context, interaction, wo, active)[1]

        def sample(self, context, interaction, sample1, sample2, active=True):
            wi = interaction.wi
            glossy = sample1 < self.chance(mi.Frame3f.cos_theta(wi))
            ggx = mi.MicrofacetDistribution(mi.MicrofacetType.GGX, self.alpha, True)
            half, _ = ggx.sample(wi, sample2)
            cosine = mi.warp.square_to_cosine_hemisphere(sample2)
            found = mi.BSDFSample3f()
            found.wo = dr.select(glossy, mi.reflect(wi, half), cosine)
            value, found.pdf = self.eval_pdf(context, interaction, found.wo, active)
            found.eta = 1.0
            kinds = mi.BSDFFlags.GlossyReflection, mi.BSDFFlags.DiffuseReflection
            kinds = [mi.UInt32(int(kind)) for kind in kinds]
            found.sampled_type = dr.select(glossy, kinds[0], kinds[1])
            found.sampled_component = dr.select(glossy, mi.UInt32(0), mi.UInt32(1))
            return found, dr.select(found.pdf > 0, value / found.pdf, 0)

        def to_string(self):
            return "MetallicRoughness[]"

    mi.register_bsdf("metallic_roughness", MetallicRoughness)
